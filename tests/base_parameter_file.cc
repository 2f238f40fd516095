// SPDX-License-Identifier: GPL-2.0-or-later
// What is read from a .prm file, and the one line that is said about each mistake in it.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/notes.h>
#include <axiforge/base/parameter_file.h>
#include <axiforge/base/wording.h>

using namespace axiforge;
using dealii::ParameterHandler;
namespace Patterns = dealii::Patterns;

namespace
{
  /// A small scene with the kinds of entries there are.
  struct Values
  {
    std::string         title        = "none";
    double              yield_stress = 100;
    int                 steps        = 10;
    bool                heat         = false;
    std::string         law          = "plastic";
    std::vector<double> velocity     = { 0, 0 };

    void declare(ParameterHandler &prm)
    {
      prm.add_parameter("Title", title, "");
      prm.add_parameter("Heat", heat, "");
      prm.enter_subsection("Material");
      prm.add_parameter("Yield stress", yield_stress, "MPa", Patterns::Double(0));
      prm.add_parameter("Law", law, "", Patterns::Selection("plastic|norton|swift"));
      prm.enter_subsection("Rate");
      prm.add_action(declared(prm, "Exponent"), [](const std::string &value) {
        if (value == "7")
          throw InputError("An exponent of 7 melts the press.");
        if (value == "8")
          throw std::runtime_error("eight");
      });
      prm.leave_subsection();
      prm.leave_subsection();
      prm.enter_subsection("Time");
      prm.add_parameter("Steps", steps, "", Patterns::Integer(1, 1000));
      prm.add_parameter("Velocity", velocity, "mm/s", Patterns::List(Patterns::Double(), 2, 2));
      prm.leave_subsection();
    }

    static std::string declared(ParameterHandler &prm, const std::string &name)
    {
      prm.declare_entry(name, "0.2", Patterns::Double());
      return name;
    }
  };

  class ParameterFileTest : public ::testing::Test
  {
  protected:
    void SetUp() override
    {
      std::string name = ::testing::TempDir() + "axiforge prm_XXXXXX"; // a blank in the path
      ASSERT_NE(::mkdtemp(name.data()), nullptr);
      folder = name;
      values.declare(prm);
    }

    void TearDown() override
    {
      std::filesystem::remove_all(folder);
    }

    std::string write(const std::string &name, const std::string &text) const
    {
      const std::string path = folder + "/" + name;
      std::filesystem::create_directories(std::filesystem::path(path).parent_path());
      std::ofstream(path, std::ios::binary) << text;
      return path;
    }

    void parse(const std::string &text, const std::vector<std::string> &overrides = {})
    {
      ParameterFile(write("case.prm", text), overrides).parse(prm);
    }

    /// The message about a faulty text; fails if there is none or if it has several lines.
    std::string message(const std::string &text, const std::vector<std::string> &overrides = {})
    {
      try
        {
          parse(text, overrides);
        }
      catch (const InputError &error)
        {
          const std::string what = error.what();
          EXPECT_EQ(what.find('\n'), std::string::npos) << what;
          const std::size_t start = what.find(folder + "/");
          return start == std::string::npos ? what
                                            : std::string(what).erase(start, folder.size() + 1);
        }
      ADD_FAILURE() << "no InputError for:\n" << text;
      return "";
    }

    std::string      folder;
    Values           values;
    ParameterHandler prm;
  };

  TEST_F(ParameterFileTest, ReadsTheLanguageOfDealII)
  {
    parse("\xEF\xBB\xBF# comment\r\n"
          "set Title = a = b # behind\r\n"
          "SUBSECTION Material\n"
          "\tset\tYield stress =  2.5e2\n"
          "  subsection   Rate # with a comment\n"
          "    set Exponent=0.1\n"
          "  end\n"
          "  set Law = nor\\\n"
          "            ton\n"
          "END\n"
          "subsection Time\n"
          "  set Velocity = 1, \\\n"
          "                 -2\n"
          "  SET Steps = 20\n"
          "end\n"
          "subsection Time\n"
          "  set Steps = 20\n"
          "end\n"
          "set Heat = true");
    EXPECT_EQ(values.title, "a = b");
    EXPECT_EQ(values.yield_stress, 250);
    EXPECT_EQ(values.law, "norton");
    EXPECT_EQ(values.velocity, (std::vector<double>{ 1, -2 }));
    EXPECT_EQ(values.steps, 20);
    EXPECT_TRUE(values.heat);
    prm.enter_subsection("Material"); // the handler is at its top level again
    prm.enter_subsection("Rate");
    EXPECT_EQ(prm.get_double("Exponent"), 0.1);
  }

  // What this reader sees and what deal.II's own sees in the same text are the same.
  TEST_F(ParameterFileTest, AgreesWithDealII)
  {
    const std::string text = "set Title = a\\\n b  c \\\n\n subsection Time\nset Steps = 4#5\n"
                             "set Velocity = 3 , 4\nend\n\nsubsection Material\n\n end \n";
    parse(text);
    Values           other;
    ParameterHandler other_prm;
    other.declare(other_prm);
    other_prm.parse_input_from_string(text);
    EXPECT_EQ(values.title, other.title);
    EXPECT_EQ(values.steps, other.steps);
    EXPECT_EQ(values.velocity, other.velocity);
  }

  TEST_F(ParameterFileTest, IncludesAreRelativeToTheFileThatHasThem)
  {
    write("parts/material.prm", "subsection Material\n include \"rate/rate.prm\"\nend\n");
    write("parts/rate/rate.prm", "subsection Rate\n set Exponent = 0.5\nend\nset Law = swift\n");
    write("parts/steps.prm", "set Steps = 77\n");
    parse("include parts/material.prm\nsubsection Time\ninclude parts/steps.prm\nend\n");
    EXPECT_EQ(values.law, "swift");
    EXPECT_EQ(values.steps, 77);
  }

  TEST_F(ParameterFileTest, OverridesComeLast)
  {
    const std::string   text = "subsection Time\n  set Steps = 20\nend # comment\n";
    const ParameterFile file(write("case.prm", text),
                             { "Time/Steps = 21", "Material/Rate/Exponent=0.3", "Title = x = y" });
    file.parse(prm);
    EXPECT_EQ(values.steps, 21);
    EXPECT_EQ(values.title, "x = y");
    EXPECT_EQ(file.text(), text);
    EXPECT_EQ(file.path(), folder + "/case.prm");
    EXPECT_EQ(file.directory(), folder);
    EXPECT_EQ(file.resolved_text(),
              "subsection Time\n  set Steps = 21\nend\n"
              "subsection Material\n  subsection Rate\n    set Exponent = 0.3\n  end\nend\n"
              "set Title = x = y\n");

    Values           other;
    ParameterHandler other_prm;
    other.declare(other_prm);
    ParameterFile(write("resolved.prm", file.resolved_text())).parse(other_prm);
    EXPECT_EQ(other.steps, 21);
  }

  // Two values in one file: one of them would do nothing.
  TEST_F(ParameterFileTest, AnEntryGivenTwice)
  {
    const std::string text =
        message("subsection Time\n set Steps = 3\nend\n"
                "subsection Time\n set Velocity = 1, 2\n set Steps = 4\nend\n");
    EXPECT_EQ(text.substr(0, 11), "case.prm:6:");
    EXPECT_NE(text.find("Entry \"Time/Steps\" = \"4\": it is given twice, with \"3\" at"),
              std::string::npos);
    EXPECT_NE(text.find("case.prm:2"), std::string::npos);
    parse("subsection Time\n set Steps = 5\n set Steps = 5\nend\n"); // the same: nothing lost
    EXPECT_EQ(values.steps, 5);
  }

  TEST_F(ParameterFileTest, AnIncludedFileMayBeChanged)
  {
    take_notes();
    write("common.prm", "set Title = common\nsubsection Time\n set Steps = 3\nend\n");
    parse("include common.prm\nsubsection Time\n set Steps = 4\nend\n", { "Time/Steps = 6" });
    EXPECT_EQ(values.steps, 6);
    EXPECT_TRUE(take_notes().empty());
    // The other way round the scene's own value does nothing.
    parse("set Title = mine\ninclude common.prm\n");
    const std::vector<std::string> notes = take_notes();
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("Entry \"Title\" = \"mine\" at"), std::string::npos);
    EXPECT_NE(notes[0].find("is replaced by \"common\""), std::string::npos);
  }

  TEST_F(ParameterFileTest, ACommentDoesNotSwallowTheNextLine)
  {
    take_notes();
    parse("subsection Time\n # values from D:\\time\\\n set Steps = 7\nend\n");
    EXPECT_EQ(values.steps, 7);
    const std::vector<std::string> notes = take_notes();
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("case.prm:2: The comment ends in a backslash"), std::string::npos);
  }

  TEST_F(ParameterFileTest, EncodingsAndLookAlikes)
  {
    parse("subsection Time\r set Steps = 8\rend\r"); // lines of old Macs
    EXPECT_EQ(values.steps, 8);
    parse("subsection Time\r\r\n set Steps = 9\r\r\nend\r\r\n");
    EXPECT_EQ(values.steps, 9);
    EXPECT_NE(message("set Nothing = 1\r").find("case.prm:1: Unknown entry"), std::string::npos);
    parse("set Title = 5 \xE2\x80\x93 6\xC2\xA0mm, \xC3\xBC\n"); // prose is free
    EXPECT_EQ(values.title, "5 \xE2\x80\x93 6\xC2\xA0mm, \xC3\xBC");

    const auto says = [&](const std::string &text, const std::string &part) {
      const std::string what = message(text);
      EXPECT_NE(what.find(part), std::string::npos) << what;
    };
    std::string wide = "\xFF\xFE";
    for (const char c : std::string("set Title = x\n"))
      (wide += c) += '\0';
    says(wide, "is in UTF-16");
    says(wide.substr(2), "is in UTF-16");
    says(std::string("set Title = x\nset Ti\0le = y\n", 29), "NUL byte in line 2");
    says("set Ti\xC2\xA0tle = x\n", "case.prm:1: \"Ti\xC2\xA0tle\" has the character U+00A0 "
                                    "(no-break space). Write an ordinary blank.");
    says("\xC2\xA0set Title = x\n", "U+00A0 (no-break space)");
    says("set Tit\xD0\xBB\x65 = x\n", "U+043B");
    says("set Tit\xFC = x\n", "the byte 0xFC, which is no UTF-8");
    says("subsection Time\n set Velocity = 0, \xE2\x88\x92\x31\nend\n",
         "case.prm:2: \"0, \xE2\x88\x92\x31\" has the character U+2212 (minus sign). Write the "
         "minus "
         "sign - of the keyboard.");
    says("subsection\xC2\xA0Time\nend\n", "U+00A0");
  }

  TEST_F(ParameterFileTest, DecimalCommasInLists)
  {
    EXPECT_NE(message("subsection Time\n set Velocity = 0, -0,5\nend\n")
                  .find("The decimal sign is a point."),
              std::string::npos);
    EXPECT_NE(
        message("subsection Time\n set Steps = 1,000\nend\n").find("The decimal sign is a point."),
        std::string::npos);
  }

  TEST_F(ParameterFileTest, IncludesWithoutEnd)
  {
    for (int level = 0; level < 20; ++level)
      write("level" + std::to_string(level) + ".prm", "include level" + std::to_string(level + 1) +
                                                          ".prm\ninclude level" +
                                                          std::to_string(level + 1) + ".prm\n");
    write("level20.prm", "set Title = x\n");
    EXPECT_NE(message("include level0.prm\n").find("the includes have no end"), std::string::npos);
    EXPECT_NE(message("include /dev/zero\n").find("is a device"), std::string::npos);
    std::filesystem::create_symlink("self.prm", folder + "/link.prm");
    write("self.prm", "include link.prm\n");
    EXPECT_NE(message("include self.prm\n").find("includes itself"), std::string::npos);
  }

  TEST_F(ParameterFileTest, FirstPassSkipsWhatIsNotDeclared)
  {
    const ParameterFile file(write("case.prm",
                                   "set Tools = upper\nsubsection Tool upper\n  subsection Motion\n"
                                   "  set Velocity = 1\n end\n set Steps = 3\nend\n"
                                   "subsection Time\n set Steps = 9\nend\n"));
    file.parse(prm, true);
    EXPECT_EQ(values.steps, 9);
    EXPECT_THROW(file.parse(prm), InputError);
    prm.enter_subsection("Time"); // the handler is at its top level again
    EXPECT_EQ(prm.get_integer("Steps"), 9);
  }

  TEST_F(ParameterFileTest, UnknownEntry)
  {
    EXPECT_EQ(
        message("subsection Material\n\n set Yeild stress = 5\nend\n"),
        "case.prm:3: Unknown entry \"Material/Yeild stress\". Did you mean \"Yield stress\"? Known "
        "in section \"Material\": \"Yield stress\" or \"Law\".");
    EXPECT_EQ(
        message("set Steps = 5\n"),
        "case.prm:1: Unknown entry \"Steps\". Did you mean \"Time/Steps\"? Known at the top level: "
        "\"Title\" or \"Heat\".");
    EXPECT_NE(message("set Material = 5\n").find("\"Material\" is a section, not an entry."),
              std::string::npos);
  }

  TEST_F(ParameterFileTest, UnknownSection)
  {
    EXPECT_EQ(
        message("subsection material\nend\n"),
        "case.prm:1: Unknown section \"material\". Did you mean \"Material\"? Known at the top "
        "level: \"Material\" or \"Time\".");
    EXPECT_EQ(message("subsection Time\nsubsection Rate\nend\nend\n"),
              "case.prm:2: Unknown section \"Time/Rate\". Did you mean \"Material/Rate\"? Nothing "
              "of that "
              "kind is known in section \"Time\".");
  }

  TEST_F(ParameterFileTest, ValuesThatAreNotAllowed)
  {
    const auto material = [&](const std::string &line) {
      return message("subsection Material\n" + line + "\nend\n");
    };
    const auto time = [&](const std::string &line) {
      return message("subsection Time\n" + line + "\nend\n");
    };
    EXPECT_EQ(material("set Yield stress = -1"), "case.prm:2: Entry \"Material/Yield stress\" = "
                                                 "\"-1\": this value is not allowed. Allowed: a "
                                                 "number not below 0.");
    EXPECT_NE(material("set Yield stress = 1,5").find("The decimal sign is a point."),
              std::string::npos);
    EXPECT_NE(material("set Yield stress = 15 MPa").find("Give the number alone"),
              std::string::npos);
    EXPECT_NE(material("set Yield stress = ").find("Entry \"Material/Yield stress\" = \"\""),
              std::string::npos);
    EXPECT_NE(material("set Yield stress = nan").find("not allowed"), std::string::npos);
    EXPECT_NE(material("set Law = Norton")
                  .find("Allowed: \"plastic\", \"norton\" or \"swift\". Did you mean \"norton\"?"),
              std::string::npos);
    EXPECT_NE(time("set Steps = 2.5").find("Allowed: a whole number from 1 to 1000."),
              std::string::npos);
    EXPECT_NE(
        time("set Velocity = 1").find("a list, separated by \",\", of 2 elements, each a number."),
        std::string::npos);
    EXPECT_NE(message("set Heat = yes\n").find("Allowed: \"true\" or \"false\"."),
              std::string::npos);
    EXPECT_EQ(values.yield_stress, 100);
  }

  TEST_F(ParameterFileTest, WhatAnActionThrows)
  {
    const std::string start = "subsection Material\nsubsection Rate\nset Exponent = ";
    EXPECT_EQ(message(start + "7\nend\nend\n"), "case.prm:3: An exponent of 7 melts the press.");
    EXPECT_EQ(message(start + "8\nend\nend\n"),
              "case.prm:3: Entry \"Material/Rate/Exponent\" = \"8\": eight.");
  }

  TEST_F(ParameterFileTest, LinesThatAreNoStatements)
  {
    EXPECT_NE(message("\nTitle = x\n").find("case.prm:2: Cannot read \"Title = x\"."),
              std::string::npos);
    EXPECT_NE(message("set Title x\n").find("case.prm:1: Cannot read \"set Title x\". Write"),
              std::string::npos);
    EXPECT_NE(message("set = x\n").find("Write \"set NAME = VALUE\"."), std::string::npos);
    EXPECT_NE(message("settle Title = x\n").find("Cannot read"), std::string::npos);
    EXPECT_NE(message("subsection\nend\n").find("\"subsection\" without a name"),
              std::string::npos);
    EXPECT_NE(
        message("subsection Time\nend Time\n").find("case.prm:2: Text behind \"end\": \"Time\""),
        std::string::npos);
  }

  TEST_F(ParameterFileTest, ALineJoinedFromSeveralIsNamedByItsFirst)
  {
    EXPECT_EQ(message("\n\nset Nothing = \\\n 1, \\\n 2\n").substr(0, 11), "case.prm:3:");
  }

  TEST_F(ParameterFileTest, UnbalancedSections)
  {
    EXPECT_NE(message("subsection Material\n\nsubsection Time\nend\n")
                  .find("case.prm:1: Section \"Material\" is opened here and never closed."),
              std::string::npos);
    EXPECT_NE(
        message("subsection Time\nend\nend\n").find("case.prm:3: \"end\" without an open section"),
        std::string::npos);
    write("part.prm", "end\n");
    EXPECT_NE(message("subsection Time\ninclude part.prm\n").find("part.prm:1: \"end\" without"),
              std::string::npos);
  }

  TEST_F(ParameterFileTest, FilesThatCannotBeRead)
  {
    EXPECT_THROW(ParameterFile(folder + "/missing.prm"), InputError);
    EXPECT_THROW(ParameterFile{ folder }, InputError);
    EXPECT_EQ(message("include missing.prm\n").substr(0, 11), "Included by");
    EXPECT_NE(message("include\n").find("\"include\" without the name of a file"),
              std::string::npos);
    EXPECT_NE(message("include case.prm\n").find("includes itself"), std::string::npos);
    write("a/part.prm", "include ../a/other.prm\n");
    write("a/other.prm", "set Title = x\ninclude ./part.prm\n");
    EXPECT_NE(message("include a/part.prm\n").find("other.prm:2: The file"), std::string::npos);
  }

  TEST_F(ParameterFileTest, AFileMayBeIncludedTwiceAndBeEmpty)
  {
    write("empty.prm", "");
    EXPECT_NO_THROW(parse("include empty.prm\ninclude empty.prm\n"));
    EXPECT_NO_THROW(parse(""));
  }

  TEST_F(ParameterFileTest, OverridesThatAreWrong)
  {
    const auto wrong = [&](const std::string &override) { return message("", { override }); };
    EXPECT_NE(wrong("Time/Steps").find("--set \"Time/Steps\": No \"=\" in it."), std::string::npos);
    EXPECT_NE(wrong("Time//Steps = 3").find("is empty"), std::string::npos);
    EXPECT_NE(wrong(" = 3").find("is empty"), std::string::npos);
    EXPECT_NE(wrong("Title = a # b").find("\"#\" and line breaks"), std::string::npos);
    EXPECT_EQ(
        wrong("Time/Step = 3"),
        "--set \"Time/Step = 3\": Unknown entry \"Time/Step\". Did you mean \"Steps\"? Known in "
        "section \"Time\": \"Steps\" or \"Velocity\".");
    EXPECT_EQ(wrong("Time/Steps = 0"), "--set \"Time/Steps = 0\": Entry \"Time/Steps\" = \"0\": "
                                       "this value is not allowed. Allowed: "
                                       "a whole number from 1 to 1000.");
  }

  TEST(Wording, ClosestName)
  {
    const std::vector<std::string> names = { "Coulomb", "constant shear", "arctan", "none" };
    EXPECT_EQ(closest_name("coulomb", names), "Coulomb");
    EXPECT_EQ(closest_name("Columb", names), "Coulomb");
    EXPECT_EQ(closest_name("constant_shear", names), "constant shear");
    EXPECT_EQ(closest_name("non", names), "none");
    EXPECT_EQ(closest_name("onne", names), "none"); // swapped neighbours
    EXPECT_EQ(closest_name("viscous", names), "");
    EXPECT_EQ(closest_name("x", {}), "");
  }

  TEST(Wording, Patterns)
  {
    const auto words = [](const Patterns::PatternBase &pattern) {
      return pattern_in_words(pattern.description());
    };
    EXPECT_EQ(words(Patterns::Double()), "a number");
    EXPECT_EQ(words(Patterns::Double(0, 1)), "a number from 0 to 1");
    EXPECT_EQ(words(Patterns::Double(Patterns::Double::min_double_value, 1)),
              "a number not above 1");
    EXPECT_EQ(words(Patterns::Integer()), "a whole number");
    EXPECT_EQ(words(Patterns::Integer(2)), "a whole number not below 2");
    EXPECT_EQ(words(Patterns::Anything()), "any text");
    EXPECT_EQ(words(Patterns::FileName()), "the name of a file");
    EXPECT_EQ(words(Patterns::DirectoryName()), "the name of a folder");
    EXPECT_EQ(words(Patterns::MultipleSelection("a|b")),
              "any of \"a\" or \"b\", separated by \",\"");
    EXPECT_EQ(
        words(Patterns::List(Patterns::List(Patterns::Double(0), 2, 2, ":"), 1)),
        "a list, separated by \",\", of at least 1 elements, each a list, separated by \":\", of 2 "
        "elements, each a number not below 0");
    EXPECT_EQ(words(Patterns::List(Patterns::Integer(), 0, 3, ";")),
              "a list, separated by \";\", of 0 to 3 elements, each a whole number");
  }
  /// Lists, files and families of sections as scenes have them.
  class ScenesOwn : public ParameterFileTest
  {
  protected:
    void SetUp() override
    {
      ParameterFileTest::SetUp();
      prm.add_parameter("Tools", tools);
      prm.enter_subsection("Tool upper");
      prm.add_parameter("Geometry file", file);
      prm.add_parameter("Geometry parameters", parameters);
      prm.leave_subsection();
    }
    std::string tools, file, parameters;
  };

  TEST_F(ScenesOwn, OneGeometryParameterIsSet)
  {
    take_notes();
    const std::string text =
        "subsection Tool upper\n set Geometry parameters = R = 10, Z = 5\nend\n";
    parse(text,
          { "Tool upper/Geometry parameters/Z = 7", "Tool upper/Geometry parameters/Draft = 3" });
    EXPECT_EQ(parameters, "R = 10, Z = 7, Draft = 3");
    const ParameterFile read(write("case.prm", text), { "Tool upper/Geometry parameters/Z = 7" });
    EXPECT_EQ(read.resolved_text(),
              "subsection Tool upper\n  set Geometry parameters = R = 10, Z = 7\nend\n");
    EXPECT_TRUE(take_notes().empty());

    parse(text, { "Tool upper/Geometry parameters = Z = 7" });
    EXPECT_EQ(parameters, "Z = 7");
    const std::vector<std::string> notes = take_notes();
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("replaces the whole list \"R = 10, Z = 5\": R back at the default"),
              std::string::npos);
    parse(text, { "Tool upper/Geometry parameters = Z = 7, R = 3" });
    EXPECT_TRUE(take_notes().empty());
  }

  TEST_F(ScenesOwn, FilesLieBesideTheFileThatNamesThem)
  {
    write("common/press.prm", "subsection Tool upper\n set Geometry file = a b.geo\nend\n");
    write("common/a b.geo", "");
    write("scenes/case.prm", "include ../common/press.prm\n");
    ParameterFile(folder + "/scenes/case.prm").parse(prm);
    EXPECT_EQ(file, "../common/a b.geo");
    std::filesystem::remove(folder + "/common/a b.geo");
    write("scenes/a b.geo", ""); // where it was looked for in earlier versions
    ParameterFile(folder + "/scenes/case.prm").parse(prm);
    EXPECT_EQ(file, "a b.geo");
    parse("subsection Tool upper\n set Geometry file = \"a b.geo\"\nend\n");
    EXPECT_EQ(file, "a b.geo");
    parse("", { "Tool upper/Geometry file = \"c d.geo\"" });
    EXPECT_EQ(file, "c d.geo");
  }

  TEST_F(ScenesOwn, AToolThatIsNotInTheList)
  {
    EXPECT_EQ(message("set Tools = upper\nsubsection Tool lower\nend\n"),
              "case.prm:2: Unknown section \"Tool lower\". The list \"Tools\" = \"upper\" does not "
              "have it: add lower to \"set Tools\", as \"set Tools = upper, lower\", or take the "
              "section out.");
    EXPECT_NE(message("set Tools = upper\nsubsection Tool uper\nend\n")
                  .find("Or did you mean \"Tool upper\"?"),
              std::string::npos);
  }

} // namespace

int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}

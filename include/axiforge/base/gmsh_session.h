// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace axiforge
{
  /// Numbers that replace the defaults of a parametric `.geo`, by name.
  using GeometryValues = std::map<std::string, double>;

  /**
   * Read "Radius = 25, Height = 12.5" (empty: no parameters).
   * Throws InputError naming @p entry, the path of the parameter the text comes from.
   */
  GeometryValues parse_geometry_parameters(const std::string &text, const std::string &entry);

  /// @p file itself if absolute, else relative to @p directory (the folder of the `.prm`).
  std::string resolve_path(const std::string &directory, const std::string &file);

  /**
   * Use of gmsh, for as long as the object lives. gmsh is one global machine: sessions may be
   * nested (the innermost `open()` decides which model is loaded, the last session to end shuts
   * gmsh down) but not used from several threads. Quiet, one thread, no configuration files of the
   * user read: the same input gives the same mesh. Errors become InputError with gmsh's own words.
   *
   * Facts of gmsh 4.8.4 this class takes care of:
   * - With `General.AbortOnError` at the API's default of 2 an error in a `.geo` throws from inside
   *   the parser and leaves gmsh locked ("I'm busy!") for good. With 0 it goes on, and all errors
   * are found in its log.
   * - `Exit;` in a `.geo` ends the whole process with status 0, `SystemCall` runs a program: such
   * files are refused.
   * - Damaged files may crash it: they are first read in a process of their own.
   */
  class GmshSession
  {
  public:
    GmshSession();
    ~GmshSession();
    GmshSession(const GmshSession &)            = delete;
    GmshSession &operator=(const GmshSession &) = delete;

    /**
     * Load `.geo`, `.msh`, `.step`, `.stp` or `.brep`, replacing the current model. Lengths in CAD
     * files are converted to mm.
     *
     * @p parameters go to a `.geo` through gmsh's ONELAB server, which knows a parameter by the
     * name given with `Name`. A `.geo` has to be written like
     *
     *     DefineConstant[ Radius = {25, Name "Radius"} ]; // mm
     *
     * so that `Geometry parameters = Radius = 30` finds it. `DefineConstant[ Radius = 25 ]` or
     * `Radius = 25;` without a `Name` can't be set from outside.
     *
     * Throws InputError, naming @p entry, for a missing file, an unknown extension, a parameter the
     * file does not define (with those it does), and everything gmsh reports as an error.
     */
    void open(const std::string    &file,
              const GeometryValues &parameters = {},
              const std::string    &entry      = "Geometry file");

    /**
     * Do @p action (calls of the gmsh API) and turn what gmsh throws or logs as an error into an
     * InputError: `Entry "<entry>" = "<file>": gmsh failed while <what>: <its words>`. Where no
     * file was opened, it is a ComputationError without the entry.
     */
    void run(const std::string &what, const std::function<void()> &action) const;

    /**
     * Do @p action in a process of its own that ends with it: where gmsh crashes or ends the
     * process, this one throws InputError instead. Its results and messages are lost.
     */
    void try_out(const std::string &what, const std::function<void()> &action) const;

    /// Tags of the model entities of a physical group. Empty if there is no such group.
    std::vector<int> entities_of_group(int dim, const std::string &name) const;

    /// Names of the physical groups of a dimension (a group without a name: its number).
    std::vector<std::string> group_names(int dim) const;

    /// Whether the text of the loaded `.geo` has a word, outside of comments and quotes.
    bool mentions(const std::string &word) const;

    /// Whether the loaded file brought a mesh and no geometry (`.msh`).
    bool holds_mesh() const;

    /// Whether the loaded file is a CAD exchange file, which has no physical groups.
    bool holds_cad() const;

  private:
    std::string file;
    std::string entry;
  };

  /// `"a", "b" or "c"`, or `none` for an empty list: for messages.
  std::string quoted_list(const std::vector<std::string> &names);
} // namespace axiforge

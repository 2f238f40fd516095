// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <axiforge/base/errors.h>
#include <axiforge/base/geometry.h>

/**
 * Binary texts that give every double back to the last bit. One function `visit(archive, object)`
 * names the members of a class for writing and for reading, so that they cannot part ways:
 *
 *     template <typename Archive> void visit(Archive &archive, Thing &thing)
 *     {
 *       auto &[size, names] = thing; // does not compile if a member is added and not named
 *       archive(size, names);
 *     }
 */
namespace axiforge
{
  namespace internal
  {
    template <typename T, typename = void> struct IsTensor : std::false_type
    {
    };

    template <> struct IsTensor<Vector2> : std::true_type
    {
    };

    template <> struct IsTensor<Point> : std::true_type
    {
    };


    /// What writing and reading share: how a value falls into numbers and bytes.
    template <typename Derived> class BinaryArchive
    {
    public:
      template <typename... T> void operator()(T &...values)
      {
        (one(values), ...);
      }

    private:
      Derived &derived()
      {
        return static_cast<Derived &>(*this);
      }

      template <typename T> void one(T &value)
      {
        if constexpr (std::is_arithmetic_v<T>)
          derived().bytes(&value, sizeof(T));
        else if constexpr (IsTensor<T>::value)
          (*this)(value[0], value[1]);
        else
          visit(derived(), value);
      }

      template <typename T, std::size_t n> void one(T (&values)[n])
      {
        for (T &value : values)
          one(value);
      }

      template <typename T, std::size_t n> void one(std::array<T, n> &values)
      {
        for (T &value : values)
          one(value);
      }

      template <typename T> void one(std::vector<T> &values)
      {
        values.resize(derived().size_of(values.size()));
        for (T &value : values)
          one(value);
      }

      void one(std::string &text)
      {
        text.resize(derived().size_of(text.size()));
        derived().bytes(text.data(), text.size());
      }

      template <typename A, typename B> void one(std::pair<A, B> &values)
      {
        (*this)(values.first, values.second);
      }

      template <typename K, typename T> void one(std::map<K, T> &values)
      {
        std::vector<std::pair<K, T>> list(values.begin(), values.end());
        one(list);
        values = std::map<K, T>(list.begin(), list.end());
      }
    };
  } // namespace internal


  /// Appends values to `text`; leaves them as they are.
  class BinaryWriter : public internal::BinaryArchive<BinaryWriter>
  {
  public:
    std::string text;

    void bytes(const void *data, const std::size_t size)
    {
      text.append(static_cast<const char *>(data), size);
    }

    std::size_t size_of(const std::size_t size)
    {
      const std::uint64_t written = size;
      bytes(&written, sizeof(written));
      return size;
    }
  };


  /// Reads values in the order they were written. The text must outlive it.
  class BinaryReader : public internal::BinaryArchive<BinaryReader>
  {
  public:
    /// @param name of the file, for messages
    BinaryReader(const std::string &text, const std::string &name)
        : text(text)
        , name(name)
    {
    }

    /// @throws InputError if the text ends before
    void bytes(void *data, const std::size_t size)
    {
      need(size);
      if (size > 0)
        std::memcpy(data, text.data() + position, size);
      position += size;
    }

    std::size_t size_of(std::size_t)
    {
      std::uint64_t size = 0;
      bytes(&size, sizeof(size));
      need(size); // every element has a byte at least
      return size;
    }

    bool at_end() const
    {
      return position == text.size();
    }

  private:
    void need(const std::size_t size) const
    {
      if (size > text.size() - position)
        throw InputError("\"" + name + "\" is damaged: it holds less than it says.");
    }

    const std::string &text;
    std::string        name;
    std::size_t        position = 0;
  };

  /// 64-bit FNV-1a hash of a text (Fowler, Noll, Vo): tells damage by accident.
  inline std::uint64_t checksum(const std::string &text)
  {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : text)
      hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return hash;
  }
} // namespace axiforge

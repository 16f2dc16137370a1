#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <lodestone/io/material.h>

#include "base/files_beside.h"
#include "mesh/image_file.h"
#include "mesh/soup_file.h"

namespace lodestone::detail {

/// The material libraries (.mtl) of an OBJ file.
class MaterialLibraries {
 public:
  /// What is missing or left out is named in `file.notes`; images go to `file.images`. Both must outlive this object.
  MaterialLibraries(const FileFetcher& fetch, SoupFile& file) : fetch_(fetch), file_(file), images_(fetch, file) {}

  /// Reads what a statement `mtllib` names: one library, blanks and all, or several.
  void add(std::string_view names);

  /// Returns the material of a name, a plain one where no library has it.
  Material material(const std::string& name);

  /// Names what was found missing or has no place in glTF, once for all materials.
  void finish();

 private:
  /// A statement as it stands in the file, after its keyword.
  struct Statement {
    std::string keyword;
    std::string arguments;
  };
  struct Entry {
    std::filesystem::path folder;
    std::map<std::string, Statement> statements;  ///< by their keywords in lower case; the last one counts
  };
  class Converter;

  bool add_library(const std::string& name, bool may_lack);
  void parse(std::string_view text, const std::filesystem::path& folder);

  const FileFetcher& fetch_;
  SoupFile& file_;
  ImageLoader images_;
  std::map<std::string, Entry> entries_;
  std::vector<std::string> unknown_;
  std::set<std::string> left_out_;  ///< keywords
  std::set<std::string> bumps_;     ///< images in colour
};

/// Cuts off a comment; a '#' inside a word is part of a name.
std::string_view without_comment(std::string_view line);

/// Returns what is left without blanks around.
std::string_view trimmed(std::string_view line);

}  // namespace lodestone::detail

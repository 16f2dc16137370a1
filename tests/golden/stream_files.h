#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lodestone/lod/progressive_mesh.h>

#include "golden/taken_stream.h"

// What the files of stream-2.0 are made of.

namespace lodestone::test {

inline constexpr char kGoldenFolder[] = "tests/golden/stream-2.0";

/// A stream as the encoder wrote it when the version was fixed.
struct EncodedFile {
  std::string name;
  std::string what;  ///< what it is there for
  std::size_t records_per_chunk = 4096;
  std::function<ProgressiveMesh()> mesh;
};
std::vector<EncodedFile> encoded_files();

/// A file made from an encoded one by an edit. All checksums are right but those that an edit is about.
struct EditedFile {
  std::string name;
  std::string source;  ///< the encoded file
  std::string what;    ///< what is done to it
  std::function<StreamBytes(TakenStream)> edit;
};
std::vector<EditedFile> valid_edits();
std::vector<EditedFile> breaking_edits();

/// Returns what a valid file is expected to be, as columns of valid.tsv: counts and the checksums of its levels.
std::string summary_of(std::span<const std::byte> bytes);
inline constexpr char kSummaryColumns[] =
    "vertices\twedges\tfaces\trecords\trounds\tsectors\tgroups\tattributes\tchunks\tbase_xxh64\tfull_xxh64";

}  // namespace lodestone::test

// Writes tests/golden/stream-2.0 anew: its files and the tables of what is expected of them.
//
//   make_golden_stream [edits]
//
// Version 2.0 is fixed, so its encoded files are: with `edits` they are read, and only what is made from them is
// written. Without, `simplify` and the encoder of today make them. Look at the difference before you keep it.

#include <fstream>
#include <iostream>
#include <string>

#include <lodestone/io/file.h>
#include <lodestone/io/stream_format.h>

#include "golden/stream_files.h"

namespace lodestone::test {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(LODESTONE_SOURCE_DIR) / kGoldenFolder;

StreamBytes read(const std::string& name) { return read_file(kFolder / (name + ".lds")).value(); }

void write(const std::string& name, const StreamBytes& bytes) {
  std::ofstream(kFolder / (name + ".lds"), std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void write_encoded() {
  for (const EncodedFile& file : encoded_files()) {
    StreamOptions options;
    options.records_per_chunk = file.records_per_chunk;
    write(file.name, encode_stream(file.mesh(), options).value());
  }
}

void write_edits() {
  for (const auto& edits : {valid_edits(), breaking_edits()})
    for (const EditedFile& file : edits) write(file.name, file.edit(TakenStream(read(file.source))));
}

void write_valid_table() {
  std::ofstream table(kFolder / "valid.tsv");
  table << "file\t" << kSummaryColumns << "\twhat\n";
  for (const EncodedFile& file : encoded_files())
    table << file.name << '\t' << summary_of(read(file.name)) << '\t' << file.what << '\n';
  for (const EditedFile& file : valid_edits())
    table << file.name << '\t' << summary_of(read(file.name)) << '\t' << file.source << ": " << file.what << '\n';
}

void write_breaking_table() {
  std::ofstream table(kFolder / "must-fail.tsv");
  table << "file\tmade of\tby\tmessage\n";
  for (const EditedFile& file : breaking_edits()) {
    const auto mesh = decode_stream(read(file.name));
    if (mesh) std::cerr << file.name << " is valid" << std::endl;
    table << file.name << '\t' << file.source << '\t' << file.what << '\t' << (mesh ? "none" : mesh.error().message)
          << '\n';
  }
}

}  // namespace
}  // namespace lodestone::test

int main(int argc, char** argv) {
  using namespace lodestone::test;
  std::filesystem::create_directories(kFolder);
  if (argc < 2 || std::string(argv[1]) != "edits") write_encoded();
  write_edits();
  write_valid_table();
  write_breaking_table();
}

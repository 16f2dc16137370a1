// Writes tests/golden/compact-3.0 and compact-3.1 anew: their files and what each decodes to.
//
//   make_golden_compact [texts | FOLDER]
//   make_golden_compact lines FILE.lods …
//
// Versions are fixed, so their files are: with `texts` they are read, and only what they decode to is written. Without,
// `simplify` and the encoder of today make them, all or those of one folder. Look at the difference before you keep it.
// With `lines` nothing is written: it prints what any streams decode to, as tests/python/compact_decoder.py does.

#include <fstream>
#include <iostream>
#include <string>

#include <lodestone/io/file.h>

#include "golden/compact_files.h"

int main(int argc, char** argv) {
  using namespace lodestone::test;
  if (argc > 1 && std::string(argv[1]) == "lines") {
    for (int i = 2; i < argc; ++i) {
      for (const std::string& line : compact_levels(lodestone::read_file(argv[i]).value())) std::cout << line << '\n';
    }
    return 0;
  }
  const std::string asked = argc > 1 ? argv[1] : "";
  const bool texts_alone = asked == "texts";
  for (const CompactFile& file : compact_files()) {
    if (!texts_alone && !asked.empty() && asked != file.folder) continue;
    const std::filesystem::path folder = std::filesystem::path(LODESTONE_SOURCE_DIR) / kGoldenFolder / file.folder;
    const std::filesystem::path path = folder / (file.name + ".lods");
    if (!texts_alone) {
      const auto bytes = file.encode();
      std::ofstream(path, std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    const auto bytes = lodestone::read_file(path).value();
    std::ofstream text(folder / (file.name + ".txt"));
    text << compact_heading(file) << '\n';
    for (const std::string& line : compact_levels(bytes)) text << line << '\n';
    std::cout << file.name << ": " << bytes.size() << " bytes\n";
  }
}

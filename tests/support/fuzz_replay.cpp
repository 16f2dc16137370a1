// Runs a fuzz target over its seeds and deterministic mutations of them, with any compiler.
//
//   TARGET [--mutations N] [--seconds S] [--write-seeds FOLDER] [FILE|FOLDER …]
//
// Files and folders are seeds, besides the target's own fuzz_seeds(). The run ends after N mutations or S seconds. On a
// crash, the input that did it lies in TARGET.crash in the working folder: run the target on it with --mutations 0.
// With --write-seeds nothing is run: all seeds go into an existing folder, for libFuzzer to begin with.

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "support/fuzz.h"
#include "support/random.h"

namespace lodestone::test {

__attribute__((weak)) std::vector<Bytes> fuzz_seeds() { return {}; }

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::uintmax_t kMaxSeedBytes = 256 * 1024;  // larger seeds cost time and find nothing more

struct Options {
  std::uint64_t mutations = 2000;
  double seconds = 5;
  fs::path crash_file;
  fs::path seed_folder;  // that they are written to; empty: they are run
  std::vector<Bytes> seeds;
};

void add_seed_file(const fs::path& path, std::vector<Bytes>& seeds) {
  if (fs::file_size(path) > kMaxSeedBytes) return;
  std::ifstream file(path, std::ios::binary);
  seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

void add_seeds(const fs::path& path, std::vector<Bytes>& seeds) {
  if (!fs::is_directory(path)) return add_seed_file(path, seeds);
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());  // the order of a folder differs between machines
  for (const fs::path& file : files) add_seed_file(file, seeds);
}

Options parse(int argc, char** argv) {
  Options options;
  options.crash_file = fs::path(argv[0]).filename().string() + ".crash";
  options.seeds = fuzz_seeds();
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--mutations" && i + 1 < argc) {
      options.mutations = std::stoull(argv[++i]);
    } else if (argument == "--seconds" && i + 1 < argc) {
      options.seconds = std::stod(argv[++i]);
    } else if (argument == "--write-seeds" && i + 1 < argc) {
      options.seed_folder = argv[++i];
    } else {
      add_seeds(argument, options.seeds);
    }
  }
  options.seeds.push_back({});
  return options;
}

/// Overwrites 1, 2, 4 or 8 bytes with a number that counts and sizes tend to break on.
void overwrite_number(Bytes& bytes, Random& random) {
  static constexpr std::uint64_t kNumbers[] = {0,
                                               1,
                                               0x7f,
                                               0x80,
                                               0xff,
                                               0x7fff,
                                               0xffff,
                                               0x7fffffff,
                                               0x80000000,
                                               0xffffffff,
                                               0x7fffffffffffffff,
                                               0xffffffffffffffff};
  const std::uint64_t number = kNumbers[random.below(std::size(kNumbers))];
  const std::size_t width = std::min<std::size_t>(std::size_t{1} << random.below(4), bytes.size());
  std::memcpy(bytes.data() + random.below(bytes.size() - width + 1), &number, width);
}

/// Copies a range of `other` over or into `bytes`.
void splice(Bytes& bytes, const Bytes& other, Random& random) {
  if (other.empty()) return;
  const std::size_t begin = random.below(other.size());
  const std::size_t length = 1 + random.below(std::min<std::size_t>(other.size() - begin, 64));
  const std::size_t at = random.below(bytes.size() + 1);
  if (random.below(2) == 0) bytes.erase(bytes.begin() + at, bytes.begin() + std::min(at + length, bytes.size()));
  bytes.insert(bytes.begin() + at, other.begin() + begin, other.begin() + begin + length);
}

void mutate_once(Bytes& bytes, const Bytes& other, Random& random) {
  if (bytes.empty()) return bytes.push_back(static_cast<std::uint8_t>(random.next()));
  switch (random.below(6)) {
    case 0:
      bytes[random.below(bytes.size())] ^= static_cast<std::uint8_t>(1u << random.below(8));
      break;
    case 1:
      bytes[random.below(bytes.size())] = static_cast<std::uint8_t>(random.next());
      break;
    case 2:
      bytes.resize(random.below(bytes.size()));
      break;
    case 3:
      splice(bytes, other, random);
      break;
    default:
      overwrite_number(bytes, random);
      break;
  }
}

/// The file that holds the input being run: after a crash nothing more is written. Kept open, or most of the time goes
/// into opening it.
class PendingInput {
 public:
  explicit PendingInput(fs::path path) : path_(std::move(path)), file_(std::fopen(path_.c_str(), "wb")) {}
  PendingInput(const PendingInput&) = delete;
  PendingInput& operator=(const PendingInput&) = delete;
  /// All inputs passed: nothing to keep.
  ~PendingInput() {
    if (file_) std::fclose(file_);
    std::error_code ignored;
    fs::remove(path_, ignored);
  }

  void set(const Bytes& bytes) {
    if (!file_) return;
    if (::ftruncate(::fileno(file_), 0) != 0) return;
    std::rewind(file_);
    if (!bytes.empty()) std::fwrite(bytes.data(), 1, bytes.size(), file_);
    std::fflush(file_);
  }

 private:
  fs::path path_;
  std::FILE* file_;
};

void run_one(const Bytes& bytes, PendingInput& pending) {
  pending.set(bytes);
  // A buffer of exactly this size: the address sanitizer sees the first byte past it. Never null, as with libFuzzer.
  const std::unique_ptr<std::uint8_t[]> exact(new std::uint8_t[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), exact.get());
  LLVMFuzzerTestOneInput(exact.get(), bytes.size());
}

int replay(const Options& options) {
  PendingInput pending(options.crash_file);
  const auto end = Clock::now() + std::chrono::duration<double>(options.seconds);
  for (const Bytes& seed : options.seeds) run_one(seed, pending);
  Random random(1);
  std::uint64_t done = 0;
  while (done < options.mutations && Clock::now() < end) {
    Bytes bytes = options.seeds[random.below(options.seeds.size())];
    const Bytes& other = options.seeds[random.below(options.seeds.size())];
    for (std::uint64_t steps = 1 + random.below(4); steps > 0; --steps) mutate_once(bytes, other, random);
    run_one(bytes, pending);
    ++done;
  }
  std::cout << options.seeds.size() << " seeds, " << done << " mutations" << std::endl;
  return 0;
}

int write_seeds(const Options& options) {
  std::size_t written = 0;
  for (const Bytes& seed : options.seeds) {
    std::ofstream file(options.seed_folder / ("seed-" + std::to_string(written)), std::ios::binary);
    file.write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
    if (!file.flush()) return std::cerr << "cannot write into " << options.seed_folder << std::endl, 1;
    ++written;
  }
  std::cout << written << " seeds written" << std::endl;
  return 0;
}

}  // namespace
}  // namespace lodestone::test

int main(int argc, char** argv) {
  const auto options = lodestone::test::parse(argc, argv);
  return options.seed_folder.empty() ? lodestone::test::replay(options) : lodestone::test::write_seeds(options);
}

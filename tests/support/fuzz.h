#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// A fuzz target is a file tests/fuzz/NAME.cpp that defines LLVMFuzzerTestOneInput. libFuzzer drives it where
// LODESTONE_LIBFUZZER is on; in every other build support/fuzz_replay.cpp does, over seeds and their mutations.

/// The entry point of a fuzz target; crashes on a defect, returns 0 otherwise.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace lodestone::test {

using Bytes = std::vector<std::uint8_t>;

/// A copy of what the library wrote.
inline Bytes bytes_of(std::span<const std::byte> written) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(written.data());
  return {first, first + written.size()};
}

/// Returns valid inputs of the target to mutate. A target may define it; the replay has an empty one in reserve.
std::vector<Bytes> fuzz_seeds();

}  // namespace lodestone::test

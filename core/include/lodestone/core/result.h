#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <tl/expected.hpp>  // The one third-party header in a public header; std::expected is C++23.

namespace lodestone {

/// What kind of thing went wrong; the message says which thing, with its numbers.
enum class ErrorCode {
  InvalidArgument,  ///< an option or parameter outside its range
  Unreadable,       ///< the file does not exist or the system would not read it
  Malformed,        ///< the bytes are not what the format says
  LimitExceeded,    ///< a count or size beyond an explicit limit
  Unsupported,      ///< valid, but not handled by this version
  NotWritten,       ///< the output could not be written
  Cancelled,        ///< the caller wanted no more
};

/// An error for a person to read: lower case, no full stop, naming the thing and its numbers.
struct Error {
  ErrorCode code = ErrorCode::Malformed;
  std::string message;
  std::optional<std::uint64_t> byte_offset;  ///< where in the input, if that means something
};

template <class T>
using Result = tl::expected<T, Error>;

/// Makes the failing side of a `Result`.
inline tl::unexpected<Error> fail(ErrorCode code, std::string message,
                                  std::optional<std::uint64_t> byte_offset = std::nullopt) {
  return tl::unexpected<Error>(Error{code, std::move(message), byte_offset});
}

}  // namespace lodestone

#pragma once

#include <functional>
#include <optional>
#include <string>

namespace lodestone::bench {

/// Runs `work` in a process of its own, a copy of this one, and returns the bytes that it returns; nothing where the
/// process came to another end, for want of memory for instance. Pre: this process has started no threads, since those
/// of a copy do not run.
std::optional<std::string> in_child(const std::function<std::string()>& work);

}  // namespace lodestone::bench

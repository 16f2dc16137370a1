#include "pipeline/build_effort.h"

#include <lodestone/pipeline/build_options.h>

namespace lodestone {

CompactCoding stream_coding_of(const BuildOptions& options) {
  return options.stream_coding.value_or(detail::build_effort(options.effort).stream_coding);
}

}  // namespace lodestone

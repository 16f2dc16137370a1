#pragma once

#include <lodestone/core/result.h>

#include "build_command.h"
#include "command.h"
#include "progress_bar.h"

namespace lodestone::tool {

/// Whether a `lodestone build` writes a stream alone, as a .lods.
bool writes_stream_file(const BuildCommand& command);

/// Does that: reads all triangles of the input as one mesh, simplifies it, writes a compact stream and says what it
/// takes. `bar` is at the beginning of this piece of the work. Errors: any; nothing is written then.
Result<Outcome> build_stream_file(const BuildCommand& command, ProgressBar& bar);

}  // namespace lodestone::tool

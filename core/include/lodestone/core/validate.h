#pragma once

#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

namespace lodestone {

/// Checks array lengths and index ranges of a mesh. Errors: InvalidArgument, naming the first entry at fault;
/// LimitExceeded where 32-bit indices cannot number its corners.
Result<void> validate(const Mesh& mesh);

/// Checks that a connectivity is a manifold with consistent links: opposites are mutual and share their edge's
/// vertices, no face repeats a vertex, no directed edge appears twice, every vertex has one fan and its anchor is the
/// first corner of it. Errors: InvalidArgument, naming the defect and where. Cost: O(n log n).
Result<void> validate(const Connectivity& mesh);

}  // namespace lodestone

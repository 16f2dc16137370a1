#include "attribute_lookup.h"

namespace lodestone::detail {

void look_up_attributes(const Mesh&, const Mesh&, Mesh&) {}

}  // namespace lodestone::detail

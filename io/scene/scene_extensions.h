#pragma once

#include "base/json.h"
#include "scene/scene_impl.h"

namespace lodestone::detail {

/// Takes out of extensionsUsed and extensionsRequired what the document does not need any more once its geometry is
/// written anew: compression, quantization, streams. The writer adds again what it uses.
void drop_replaced_extensions(const Scene::Impl& scene, Json& document);

}  // namespace lodestone::detail

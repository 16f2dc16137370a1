#pragma once

// tinygltf as lodestone uses it: without stb, since images stay the files they are, and without files of its own.

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_INCLUDE_JSON

#include <tiny_gltf.h>

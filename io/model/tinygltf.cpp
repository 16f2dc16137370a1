// tinygltf's own code, alone in its object file: the linker takes it out of the library only where a program has none
// of its own, from TINYGLTF_IMPLEMENTATION or from libtinygltf. It is whole but for stb, since such a program may use
// it for files, too; the rest of lodestone, with model/tinygltf.h, asks it for none.

#include <fstream>

#include <nlohmann/json.hpp>

#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_JSON

#include <tiny_gltf.h>

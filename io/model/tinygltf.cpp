// tinygltf's own code, alone in its object file: the linker takes it out of the library only where a program has none
// of its own, from TINYGLTF_IMPLEMENTATION or from libtinygltf.

#include <fstream>  // tinygltf 2.7 needs it although it is told to leave files alone

#include <nlohmann/json.hpp>

#define TINYGLTF_IMPLEMENTATION
#include "model/tinygltf.h"

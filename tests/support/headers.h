#pragma once

// What most tests include and takes long to read: precompiled.

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/lod/simplify.h>

#include "support/catch.h"

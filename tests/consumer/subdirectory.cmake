# The source by add_subdirectory, for a program that only draws from a stream: builds no more of it, and needs no more than zstd.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)
foreach(package draco assimp nlohmann_json meshoptimizer GEOS TBB CLI11 ZLIB Catch2)
  list(APPEND without -D CMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
build_programs(build -D LODESTONE_SOURCE=${LODESTONE_SOURCE} -D LODESTONE_RUNTIME_ONLY=ON -D CMAKE_UNITY_BUILD=ON ${without})
run_draw(build)
file(GLOB_RECURSE libraries RELATIVE ${WORK_DIR}/build ${WORK_DIR}/build/*.a ${WORK_DIR}/build/*.so)
list(LENGTH libraries count)
if(NOT count EQUAL 4)
  message(FATAL_ERROR "built ${libraries}, not just core, progressive, stream and c")
endif()

# The package as this build installs it, by find_package and by pkg-config. Takes BUILD_DIR, too, and SANITIZE: flags. Optimising the
# programs would take longer than all that they do.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)
run_step(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
build_programs(build -D CMAKE_BUILD_TYPE=Release -D CMAKE_C_FLAGS_RELEASE=-DNDEBUG -D CMAKE_CXX_FLAGS_RELEASE=-DNDEBUG
               -D CMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
run_programs(build ${LODESTONE_SOURCE}/demo/suzi.glb)
run_with_pkg_config()

# The source by FetchContent, as shared libraries, which are then installed and used as a package by find_package and by
# pkg-config. Not optimised: it is the longest of the tests as it is.

include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)
build_programs(fetched -D LODESTONE_SOURCE=${LODESTONE_SOURCE} -D LODESTONE_BY=FetchContent
               -D BUILD_SHARED_LIBS=ON -D LODESTONE_INSTALL=ON -D CMAKE_CXX_FLAGS=-O0)
run_programs(fetched ${WORK_DIR}/level.obj)
run_step(${CMAKE_COMMAND} --install ${WORK_DIR}/fetched --prefix ${WORK_DIR}/prefix)
file(REMOVE_RECURSE ${WORK_DIR}/fetched)  # what is found now is what is installed
build_programs(installed -D CMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
run_programs(installed ${WORK_DIR}/level.obj)
run_with_pkg_config()

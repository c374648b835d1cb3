# Configures a project that has the sources of SimVis inside, in both ways, and builds its client: without tests, benchmarks,
# Python module and package, but with that of ROS, which is only installed. Needs SOURCE_DIR (of SimVis) and FOLDER (where to build).
include(${CMAKE_CURRENT_LIST_DIR}/installed.cmake)
file(REMOVE_RECURSE ${FOLDER})
foreach(fetch OFF ON)
  set(build ${FOLDER}/fetch_${fetch})
  run(${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR}/inside -B ${build} -DSIMVIS=${SOURCE_DIR} -DFETCH=${fetch})
  if(NOT output MATCHES "targets ([0-9]+); subdirectories \\[[^;]*program/ros\\]; package name \\[\\]" OR CMAKE_MATCH_1 LESS 10)
    message(FATAL_ERROR "a project with SimVis inside has its tests, benchmarks or package, or lacks its library:\n${output}")
  endif()
  run(${CMAKE_COMMAND} --build ${build} --target inside_client)
  run(${build}/inside_client)
endforeach()

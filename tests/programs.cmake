# The test programs. The other files of the folder make one library for all of them, with doctest's main in test_main.cpp.
# The product has all checks; of the tests' own code those of undefined behaviour would take a third of its compile time.
if(SIMVIS_SANITIZE MATCHES "undefined")
  add_compile_options(-fno-sanitize=undefined)
endif()

file(GLOB shared CONFIGURE_DEPENDS support/*.cpp)
add_library(simvis_test_main STATIC ${shared})
target_link_libraries(simvis_test_main PUBLIC simvis OpenEXR::OpenEXR nlohmann_json::nlohmann_json PkgConfig::stb
                                              ${CMAKE_DL_LIBS})
target_include_directories(simvis_test_main PUBLIC ${PROJECT_SOURCE_DIR})
target_compile_definitions(simvis_test_main PUBLIC
  SIMVIS_SOURCE_DIR="${PROJECT_SOURCE_DIR}" SIMVIS_BINARY_DIR="${PROJECT_BINARY_DIR}"
  SIMVIS_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data")

# For the thread sanitizer host_thread_tests are built with no more than what they test, so that this takes a minute.
if(SIMVIS_SANITIZE MATCHES "thread")
  file(GLOB host_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/engine/base/*.cpp ${PROJECT_SOURCE_DIR}/engine/draw/*.cpp
                                           ${PROJECT_SOURCE_DIR}/engine/geometry/*.cpp
                                           ${PROJECT_SOURCE_DIR}/engine/raycast/*.cpp)
  list(FILTER host_sources EXCLUDE REGEX "/raycast/(device_.*|ray_block|ray_caster|ray_dispatch|ray_mesh_pool|ray_top).cpp$")
  add_library(simvis_host_threads STATIC EXCLUDE_FROM_ALL
              ${host_sources} ${PROJECT_SOURCE_DIR}/simvis/output/encoding_queue.cpp support/test_main.cpp
              support/temporary_folder.cpp)
  target_include_directories(simvis_host_threads PUBLIC ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR})
  target_link_libraries(simvis_host_threads PUBLIC glm::glm Threads::Threads)
endif()

foreach(source IN LISTS tests)
  get_filename_component(name ${source} NAME_WE)
  add_executable(${name} ${source})
  if(SIMVIS_SANITIZE MATCHES "thread" AND name IN_LIST host_thread_tests)
    target_link_libraries(${name} PRIVATE simvis_host_threads)
    continue()
  endif()
  target_link_libraries(${name} PRIVATE simvis_test_main)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)  # compiles in two thirds of the time
  if(SIMVIS_PRECOMPILE AND first)
    target_precompile_headers(${name} REUSE_FROM ${first})
  elseif(SIMVIS_PRECOMPILE)
    set(first ${name})
    target_precompile_headers(${name} PRIVATE <doctest/doctest.h> <filesystem> <fstream> <glm/gtc/matrix_transform.hpp>
                                              <random> <sstream> support/gltf_fixture.h <simvis/simulation.h>)
  endif()
endforeach()

add_executable(hard_cases_test ${hard_cases})
target_link_libraries(hard_cases_test PRIVATE simvis_test_main)
target_compile_options(hard_cases_test PRIVATE $<$<CONFIG:Release>:-O1>)
if(SIMVIS_PRECOMPILE)
  target_precompile_headers(hard_cases_test PRIVATE <algorithm> <doctest/doctest.h> <functional> <glm/glm.hpp> <memory>)
endif()

# Parts of the import program that no file reaches in every way.
target_link_libraries(mesh_files_test PRIVATE simvis_import_mesh)
target_link_libraries(vertex_numbers_test PRIVATE simvis_import_mesh)

add_dependencies(plugin_test simvis-run simvis_example_plugin)
add_dependencies(refused_plugin_test ${refused_plugin_targets})
add_dependencies(cli_test simvis-run)
add_dependencies(docs_test simvis-run)
add_dependencies(docs_commands_test simvis-run)
target_compile_definitions(docs_commands_test PRIVATE SIMVIS_CXX_COMPILER="${CMAKE_CXX_COMPILER}")
add_dependencies(price_test simvis-run)
add_dependencies(psd_test simvis-run)
add_dependencies(shard_test simvis-run)
add_dependencies(side_by_side_test simvis_example_plugin)
add_dependencies(threads_option_test simvis-run)

# OpenCV's semi-global matching and lens models, where they are there. Debian has these two libraries apart from the package of all of
# OpenCV, which is the one that carries the CMake files.
find_path(SIMVIS_OPENCV_INCLUDE opencv2/calib3d.hpp PATH_SUFFIXES opencv4)
find_library(SIMVIS_OPENCV_CALIB3D opencv_calib3d)
find_library(SIMVIS_OPENCV_CORE opencv_core)
mark_as_advanced(SIMVIS_OPENCV_INCLUDE SIMVIS_OPENCV_CALIB3D SIMVIS_OPENCV_CORE)
if(SIMVIS_OPENCV_INCLUDE AND SIMVIS_OPENCV_CALIB3D AND SIMVIS_OPENCV_CORE)
  foreach(name stereo_matching_test lens_test camera_lens_test)
    target_include_directories(${name} SYSTEM PRIVATE ${SIMVIS_OPENCV_INCLUDE})
    target_link_libraries(${name} PRIVATE ${SIMVIS_OPENCV_CALIB3D} ${SIMVIS_OPENCV_CORE})
    target_compile_definitions(${name} PRIVATE SIMVIS_HAS_OPENCV)
  endforeach()
endif()

add_custom_target(host_thread_tests DEPENDS ${host_thread_tests})
add_custom_target(thread_tests DEPENDS ${thread_tests})

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

foreach(source IN LISTS tests)
  get_filename_component(name ${source} NAME_WE)
  add_executable(${name} ${source})
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

add_dependencies(plugin_test simvis-run simvis_example_plugin)
add_dependencies(cli_test simvis-run)
add_dependencies(docs_test simvis-run)
add_dependencies(docs_commands_test simvis-run)
target_compile_definitions(docs_commands_test PRIVATE SIMVIS_CXX_COMPILER="${CMAKE_CXX_COMPILER}")
add_dependencies(price_test simvis-run)
add_dependencies(psd_test simvis-run)
add_dependencies(shard_test simvis-run)

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

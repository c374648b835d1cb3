# The test programs: one for each of `modules`. They link the objects of the library, since they use what is private.
# The product has all checks; of the tests' own code those of undefined behaviour would take a third of its compile time.
if(SIMVIS_SANITIZE MATCHES "undefined")
  add_compile_options(-fno-sanitize=undefined)
endif()

# OpenCV's semi-global matching and lens models, where they are there. Debian has these two libraries apart from the
# package of all of OpenCV, which is the one that carries the CMake files.
find_path(SIMVIS_OPENCV_INCLUDE opencv2/calib3d.hpp PATH_SUFFIXES opencv4)
find_library(SIMVIS_OPENCV_CALIB3D opencv_calib3d)
find_library(SIMVIS_OPENCV_CORE opencv_core)
mark_as_advanced(SIMVIS_OPENCV_INCLUDE SIMVIS_OPENCV_CALIB3D SIMVIS_OPENCV_CORE)
if(SIMVIS_OPENCV_INCLUDE AND SIMVIS_OPENCV_CALIB3D AND SIMVIS_OPENCV_CORE)
  set(opencv_effects ${SIMVIS_OPENCV_CALIB3D} ${SIMVIS_OPENCV_CORE})
  set(opencv_sensors ${opencv_effects})
endif()

# One set of precompiled headers serves all test objects, and with SIMVIS_UNITY a unit has several files, which takes less
# than half of the compile time. Their names must then be unique within a folder. -O1 compiles in two thirds of the time
# of -O3, and -O0 in half the time of -O1: it is for modules whose tests compute little themselves, and these share a second
# set of precompiled headers.
set(modules_that_compute_little clients elements fuzz import messages scenegraph scenes simvis sources)
function(simvis_test_objects target)
  target_compile_definitions(${target} PRIVATE SIMVIS_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                             SIMVIS_BINARY_DIR="${PROJECT_BINARY_DIR}" SIMVIS_TEST_DATA="${SIMVIS_TEST_DATA}"
                             SIMVIS_CXX_COMPILER="${CMAKE_CXX_COMPILER}")
  set(optimization -O1)
  set(headers_of simvis_test_base)
  string(REGEX REPLACE "^simvis_(.*)_test_objects$" "\\1" module ${target})
  if(module IN_LIST modules_that_compute_little)
    set(optimization -O0)
    list(GET modules_that_compute_little 0 first)
    set(headers_of simvis_${first}_test_objects)
  endif()
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${optimization}>)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SIMVIS_UNITY} UNITY_BUILD_BATCH_SIZE 10)
  if(target STREQUAL headers_of)
    target_precompile_headers(${target} PRIVATE <doctest/doctest.h> <filesystem> <fstream> <glm/gtc/matrix_transform.hpp>
                                                <random> <sstream> support/parts/gltf_fixture.h <simvis/simulation.h>)
  else()
    target_precompile_headers(${target} REUSE_FROM ${headers_of})
  endif()
endfunction()

# support/ makes two libraries: simvis_test_base, with doctest's main, needs no more than the public headers; the rest uses
# what is private.
if(NOT SIMVIS_TESTS_FROM)
  set(base support/parts/gltf_fixture.cpp support/temporary_folder.cpp support/test_main.cpp support/wall_scene.cpp)
  add_library(simvis_test_base STATIC ${base})
  target_include_directories(simvis_test_base PUBLIC ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include)
  target_link_libraries(simvis_test_base PUBLIC glm::glm nlohmann_json::nlohmann_json PkgConfig::stb)
  simvis_test_objects(simvis_test_base)
  file(GLOB support RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS support/*.cpp support/parts/*.cpp)
  list(REMOVE_ITEM support ${base} support/one_mapping.cpp)  # for the thread sanitizer alone
  add_library(simvis_test_support STATIC ${support})
  target_link_libraries(simvis_test_support PUBLIC simvis_internals simvis_test_base)
  simvis_test_objects(simvis_test_support)
endif()

# A module's objects are an archive, so that another build can link them: behind its own, because the linker takes the first
# of several copies of an inline function, which is then the one with that build's checks.
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/program.cpp "")
foreach(module IN LISTS modules)
  add_executable(${module}_tests ${CMAKE_CURRENT_BINARY_DIR}/program.cpp)
  if(module STREQUAL public)
    continue()
  endif()
  if(SIMVIS_TESTS_FROM)
    foreach(objects IN LISTS simvis_objects simvis_program_objects)
      target_sources(${module}_tests PRIVATE $<TARGET_OBJECTS:${objects}>)
    endforeach()
    set(archives ${SIMVIS_TESTS_FROM}/tests)
    target_link_libraries(${module}_tests PRIVATE
                          $<LINK_LIBRARY:WHOLE_ARCHIVE,${archives}/libsimvis_${module}_test_objects.a>
                          ${archives}/libsimvis_test_support.a ${archives}/libsimvis_test_base.a
                          ${opencv_${module}} ${simvis_needs} ${simvis_program_needs})
    continue()
  endif()
  file(GLOB sources CONFIGURE_DEPENDS ${module}/*.cpp)
  add_library(simvis_${module}_test_objects STATIC ${sources})
  target_link_libraries(simvis_${module}_test_objects PRIVATE simvis_test_support)
  simvis_test_objects(simvis_${module}_test_objects)
  if(opencv_${module})
    target_include_directories(simvis_${module}_test_objects SYSTEM PRIVATE ${SIMVIS_OPENCV_INCLUDE})
    target_compile_definitions(simvis_${module}_test_objects PRIVATE SIMVIS_HAS_OPENCV)
  endif()
  target_link_libraries(${module}_tests PRIVATE simvis_internals
                        $<LINK_LIBRARY:WHOLE_ARCHIVE,simvis_${module}_test_objects> simvis_test_support ${opencv_${module}})
endforeach()
# public/ tests what other programs and plug-ins see: it uses the shared library, and of support/ what needs no more.
if(SIMVIS_TESTS_FROM)
  set(public_objects ${archives}/libsimvis_public_test_objects.a)
  set(test_base ${archives}/libsimvis_test_base.a)
else()
  file(GLOB sources CONFIGURE_DEPENDS public/*.cpp)
  add_library(simvis_public_test_objects STATIC ${sources})
  target_link_libraries(simvis_public_test_objects PUBLIC simvis simvis_test_base)
  simvis_test_objects(simvis_public_test_objects)
  set(public_objects simvis_public_test_objects)
  set(test_base simvis_test_base)
endif()
target_link_libraries(public_tests PRIVATE $<LINK_LIBRARY:WHOLE_ARCHIVE,${public_objects}> ${test_base} simvis Threads::Threads ${CMAKE_DL_LIBS})
add_dependencies(public_tests simvis-try-plugin simvis-testing simvis_example_plugin ${refused_plugin_targets})

target_link_libraries(clients_tests PRIVATE simvis_client)
add_dependencies(clients_tests simvis-ctl)
if(CycloneDDS_FOUND AND TARGET simvis_messages_test_objects)
  target_compile_definitions(simvis_messages_test_objects PRIVATE SIMVIS_HAS_DDS)
endif()
# Another vendor's DDS, where it is there.
find_package(fastrtps QUIET)
if(fastrtps_FOUND AND NOT SIMVIS_SANITIZE)
  add_executable(fast_dds_peer messages/peer/fast_dds_peer.cpp)
  target_link_libraries(fast_dds_peer PRIVATE fastrtps fastcdr)
  add_dependencies(clients_tests fast_dds_peer)
endif()
# Parts of the import program that no file reaches in every way.
# And the libraries that decode, whose encoders make what the tests decode.
target_link_libraries(fuzz_tests PRIVATE simvis_client simvis_import_mesh simvis_decode)
target_link_libraries(import_tests PRIVATE simvis_import_mesh simvis_decode meshoptimizer::meshoptimizer)
add_dependencies(simvis_tests simvis-run simvis_example_plugin simvis_failing_calls simvis_hostile_library
                 simvis_failing_allocations each_allocation
                 simvis_fault_layer)
add_dependencies(sensors_tests simvis-run)
if(TARGET simvis-dynamics)
  add_dependencies(dynamics_tests simvis-dynamics)
endif()

# For the thread sanitizer: what runs on several threads of the host, built with no more than that, so that it takes a
# minute and needs no Vulkan.
if(SIMVIS_SANITIZE MATCHES "thread")
  file(GLOB host_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/engine/base/*.cpp ${PROJECT_SOURCE_DIR}/engine/draw/*.cpp
                                           ${PROJECT_SOURCE_DIR}/engine/geometry/*.cpp
                                           ${PROJECT_SOURCE_DIR}/engine/raycast/*.cpp ${PROJECT_SOURCE_DIR}/exchange/clients/*.cpp)
  list(FILTER host_sources EXCLUDE REGEX
       "/raycast/(device_.*|gpu_ray_instance|ray_caster|ray_dispatch|blas_pool|tlas|cost_model).cpp$")
  add_executable(host_threads_tests EXCLUDE_FROM_ALL
                 ${host_sources} ${PROJECT_SOURCE_DIR}/scenegraph/array_bytes.cpp
                 ${PROJECT_SOURCE_DIR}/program/output/encoding_queue.cpp support/test_main.cpp
                 support/temporary_folder.cpp engine/thread_pool_test.cpp engine/cache_file_test.cpp
                 simvis/encoding_queue_test.cpp raycast/ray_threads_test.cpp
                 ${PROJECT_SOURCE_DIR}/exchange/clients/client.c clients/writers_test.cpp support/one_mapping.cpp)
  target_include_directories(host_threads_tests PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR})
  target_link_libraries(host_threads_tests PRIVATE glm::glm Threads::Threads meshoptimizer::meshoptimizer OpenSSL::Crypto
                                                   ${CMAKE_DL_LIBS})
  target_link_options(host_threads_tests PRIVATE LINKER:--wrap=mmap,--wrap=munmap)
  target_compile_options(host_threads_tests PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-tsan>)  # it does not model fences
  target_compile_definitions(host_threads_tests PRIVATE SIMVIS_BINARY_DIR="${PROJECT_BINARY_DIR}"
                                                        SIMVIS_TEST_DATA="${SIMVIS_TEST_DATA}")
endif()

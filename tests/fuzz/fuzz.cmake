# The program simvis-fuzz, for the preset `fuzz`: libFuzzer with all targets of this folder. tools/fuzz runs it.
set(folder ${PROJECT_SOURCE_DIR}/tests)
file(GLOB targets CONFIGURE_DEPENDS ${folder}/fuzz/*_targets.cpp)
add_executable(simvis-fuzz EXCLUDE_FROM_ALL ${folder}/fuzz/program/fuzz_main.cpp
               ${folder}/fuzz/program/coverage.cpp ${folder}/fuzz/fuzz_target.cpp ${targets}
               ${folder}/support/temporary_folder.cpp)
target_link_libraries(simvis-fuzz PRIVATE simvis_internals simvis_client simvis_import_mesh simvis_decode)
if(TARGET simvis-dynamics)  # is loaded by scenes with physics
  add_dependencies(simvis-fuzz simvis-dynamics)
endif()
target_link_options(simvis-fuzz PRIVATE -fsanitize=fuzzer)

# The kind of a test, which is one of its labels: `ctest -L unit` takes less than a minute on two cores.
#
#   soak      takes 2.5 s and more of two cores (soak_tests, as measured), or tries something at random many times (long_count.h)
#   program   starts programs: what includes run_process.h, directly or by another header of the tests, or calls fork() or
#             popen()
#   unit      all others. Of these a test opens a Vulkan device only if it steps a simulation or draws.
set(soak_tests
    clients/dds_follower_test clients/dds_test clients/driven_map_test clients/examples_test clients/serve_test culling/culling_test
    datasets/dataset_folder_test datasets/readers_test
    dynamics/robots_test effects/beam_divergence_test effects/camera_effects_test effects/camera_lens_test
    effects/effects_test engine/mesh_levels_test fidelity/coverage_test hard_cases/edges_test hard_cases/order_test hard_cases/watertight_test
    import/gltf_animation_test import/gltf_malformed_test import/gltf_test import/inventor_errors_test
    import/mesh_file_errors_test live/foxglove_packages_test live/live_option_test live/live_page_test
    live/recorded_page_test live/server_test messages/readers_test public/side_by_side_test raycast/random_scenes_test
    raycast/ray_caster_test raycast/ray_engines_test scenegraph/random_commands_test scenes/house_test
    scenes/marvin_scene_test scenes/ravon_scene_test sensors/auto_scan_test sensors/depth_error_bound_test
    sensors/hybrid_scan_test sensors/lens_sensors_test sensors/noisy_readings_test sensors/same_bytes_test sensors/scan_accuracy_test
    sensors/scanner_presets_test
    sensors/stereo_matching_test
    simvis/clock_test simvis/price_test simvis/replay_test simvis/second_run_test simvis/vector_simulation_test sources/docs_commands_test
    state/restored_history_test state/restored_physics_test state/restored_sensors_test state/wrong_states_test)

# Sets `result` to the names of the tests' headers that start programs, as a regular expression.
function(simvis_process_headers result)
  set(all run_process)
  set(found run_process)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS *.h)
  while(found)
    list(JOIN all "|" names)
    set(found)
    foreach(header IN LISTS headers)
      get_filename_component(name ${header} NAME_WE)
      file(STRINGS ${header} starts REGEX "^#include \"tests/[a-z_/]*/(${names})\\.h\"")
      if(starts AND NOT name IN_LIST all)
        list(APPEND found ${name})
      endif()
    endforeach()
    list(APPEND all ${found})
  endwhile()
  list(JOIN all "|" all)
  set(${result} ${all} PARENT_SCOPE)
endfunction()
simvis_process_headers(process_headers)

# The kind of the test `test`, MODULE/NAME, of the file `source`.
function(simvis_test_kind result test source)
  file(STRINGS ${source} counts REGEX "^#include \"tests/support/long_count\\.h\"")
  file(STRINGS ${source} starts REGEX "^#include \"tests/[a-z_/]*/(${process_headers})\\.h\"|::fork\\(| popen\\(")
  if(test IN_LIST soak_tests OR counts)
    set(kind soak)
  elseif(starts)
    set(kind program)
  else()
    set(kind unit)
  endif()
  set(${result} ${kind} PARENT_SCOPE)
endfunction()

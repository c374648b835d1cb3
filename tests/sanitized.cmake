# What `./test --all` runs again with the address and undefined-behaviour sanitizers: tests of what parses input, owns
# memory or runs on threads, with the label `sanitized`. Tests of how exact or how fast something is run in Release alone:
# they compute for long, in code that the tests below run too. Every module is in one of three lists.

# Whole modules.
set(sanitized_modules
    clients      # shared memory that other processes write, requests of strangers, threads
    fuzz         # corpora of all readers of foreign bytes
    import       # part files
    live         # requests of browsers, threads
    maps         # grids of strangers; indices of cells
    messages     # recordings, messages of strangers
    public       # plug-ins; simulations on several threads
    scenegraph   # scene files; parts that scenes share and drop
    state)       # bytes of strangers; bodies of the engine, which live in its memory

# Files of these modules that do not count: other programs read what SimVis wrote, a whole drive is judged, or moving edges are
# followed for minutes. What SimVis runs for them, other files of the modules run too.
set(unsanitized_files clients/driven_map_test messages/event_packet_test messages/packet_decoders_test
                      messages/readers_test)

# Modules of which some files count, and these files.
set(partly_sanitized_modules datasets dynamics elements engine fidelity light raycast sensors simvis splats)
set(sanitized_files
    # files of several processes, which it reads again
    datasets/dataset_folder_test
    # robots and worlds of SDF and MJCF; bodies of the engine, which live in its memory
    dynamics/bodies_test dynamics/convex_pieces_test dynamics/physics_test dynamics/robots_test dynamics/sdf_robots_test
    dynamics/sdf_worlds_test
    # meshes that live for one frame, graphs that are changed
    elements/animation_test elements/elements_test elements/graph_test elements/point_cloud_test elements/trail_test
    # files of the cache; memory of the device and what lies in it; threads
    engine/cache_file_test engine/cluster_cache_test engine/device_copies_test engine/device_memory_test
    engine/device_test engine/draw_list_test engine/free_ranges_test engine/item_index_test engine/renderer_upload_test
    engine/thread_pool_test engine/tree_cache_test
    # captures and recordings of strangers
    fidelity/recording_readers_test
    # paths of light: indices of pixels, paths and light rays
    light/path_camera_test
    raycast/ray_threads_test
    # each kind of sensor once, since it owns its results
    sensors/camera_test sensors/environment_sensors_test sensors/laser_scanner_test sensors/light_sensor_test
    sensors/navigation_test sensors/proximity_test sensors/psd_test sensors/radar_test sensors/stereo_camera_test
    # the command line and the files that it reads; files that it writes; plug-ins; threads; scenes that are changed
    simvis/again_test simvis/cli_input_errors_test simvis/cli_machine_errors_test simvis/cli_test
    simvis/encoding_queue_test simvis/fork_test simvis/formats_test simvis/given_up_device_test simvis/keep_test simvis/live_scene_test simvis/messages_test
    simvis/output_writer_test simvis/package_option_test simvis/parameters_test simvis/picture_file_test
    simvis/plugin_lidar_test simvis/plugin_test simvis/remove_test simvis/replay_test simvis/resume_test
    simvis/scene_check_test simvis/shard_test simvis/simulation_calls_test simvis/simulation_test simvis/step_async_test
    simvis/strict_leniency_test simvis/threads_option_test simvis/timeline_test simvis/trajectory_test
    simvis/vector_simulation_test simvis/vulkan_faults_test
    # files of strangers; threads
    splats/splat_files_test splats/splat_rays_test)

# Sweeps of accuracy, culling, effects and scenes, and tests of the sources, which read no foreign bytes.
set(unsanitized_modules combinations culling effects hard_cases scenes sources)

foreach(module IN LISTS modules)
  set(lists ${sanitized_modules} ${partly_sanitized_modules} ${unsanitized_modules})
  if(NOT module IN_LIST lists)
    message(FATAL_ERROR "tests/${module} is in none of the lists of modules in tests/sanitized.cmake")
  endif()
endforeach()

# Whether the test MODULE/NAME counts.
function(simvis_test_sanitized result module name)
  set(${result} FALSE PARENT_SCOPE)
  if("${module}/${name}" IN_LIST unsanitized_files)
    return()
  endif()
  if(module IN_LIST sanitized_modules OR "${module}/${name}" IN_LIST sanitized_files)
    set(${result} TRUE PARENT_SCOPE)
  endif()
endfunction()

# The programs that `ctest -L sanitized` runs.
add_custom_target(sanitized_tests)
add_dependencies(sanitized_tests simvis-run)
foreach(module IN LISTS sanitized_modules partly_sanitized_modules)
  add_dependencies(sanitized_tests ${module}_tests)
endforeach()

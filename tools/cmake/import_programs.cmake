# The programs that SimVis starts to read part files with other projects' libraries, which may crash or hang on broken
# files: simvis-import-mesh (Assimp) and, where there is Coin, simvis-import-inventor. Two programs, because Coin brings
# libraries of X11 and OpenGL along, whose loading would be most of the time that it takes to read a small mesh. A third,
# simvis-decode, decodes pictures and meshes within such files.
#
# They stand in the folder `simvis` beside the library, in the build tree as where they are installed.
set(SIMVIS_IMPORT_FOLDER simvis)

# What they share with the library; both compile it, so that starting a program does not load all of SimVis.
set(import_shared
    engine/base/folder_entries.cpp
    engine/base/input_file.cpp
    engine/base/input_log.cpp
    engine/base/read_error.cpp
    engine/base/read_fence.cpp
    engine/base/read_scope.cpp
    engine/draw/mesh.cpp
    scenegraph/content_pool.cpp
    import/programs/failed_allocations.cpp
    import/programs/file_access.cpp
    import/programs/process_limits.cpp
    import/programs/reported_faults.cpp
    import/programs/system_calls.cpp
    import/mesh/name_case.cpp
    import/mesh/percent_encoding.cpp
    import/mesh/png_chunks.cpp
    import/mesh/picture_search.cpp
    import/mesh/stb_picture.cpp
    import/mesh/stb_stream.cpp
    import/mesh/zip_archive.cpp
    import/sandbox/draco_mesh.cpp
    import/sandbox/import_answer.cpp
    import/sandbox/import_limits.cpp
    import/sandbox/imported_scene.cpp
    import/sandbox/picture_values.cpp
    scenegraph/language/attributes.cpp
    scenegraph/language/command.cpp
    scenegraph/language/location.cpp
    scenegraph/language/nearest_name.cpp
    scenegraph/language/source_text.cpp
    scenegraph/language/xml_error.cpp
    scenegraph/language/xml_text.cpp
    scenegraph/pictures/deflate.cpp)
add_library(simvis_import_shared STATIC ${import_shared})
simvis_unity(simvis_import_shared "${import_shared}")
target_include_directories(simvis_import_shared PUBLIC ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR})
target_link_libraries(simvis_import_shared PUBLIC glm::glm pugixml::pugixml PkgConfig::stb PkgConfig::libdeflate)
set_target_properties(simvis_import_shared PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
simvis_precompiled_headers(simvis_import_shared)

set(helper ${PROJECT_SOURCE_DIR}/import/programs)
function(simvis_helper_program name main library)
  add_executable(${name} ${main})
  target_link_libraries(${name} PRIVATE ${library})
  set_target_properties(${name} PROPERTIES
                        RUNTIME_OUTPUT_DIRECTORY ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/${SIMVIS_IMPORT_FOLDER})
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_LIBDIR}/${SIMVIS_IMPORT_FOLDER})
  # Whatever is linked with the library can read every kind of part.
  add_dependencies(simvis ${name})
endfunction()
function(simvis_import_program kind library)
  file(GLOB sources CONFIGURE_DEPENDS ${ARGN})
  add_library(simvis_import_${kind} STATIC ${sources})
  simvis_unity(simvis_import_${kind} "${sources}")
  target_link_libraries(simvis_import_${kind} PUBLIC simvis_import_shared ${library})
  set_target_properties(simvis_import_${kind} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  simvis_precompiled_headers(simvis_import_${kind})
  simvis_helper_program(simvis-import-${kind} ${helper}/import_main.cpp simvis_import_${kind})
endfunction()

add_library(simvis_any_picture STATIC ${helper}/decode/any_picture.cpp ${helper}/decode/pnm_picture.cpp)
target_link_libraries(simvis_any_picture PUBLIC simvis_import_shared PkgConfig::webp PkgConfig::tiff tiffxx)
add_library(simvis_decode STATIC ${helper}/decode/draco_reader.cpp ${helper}/decode/exr_file.cpp
            ${helper}/decode/sky_radiance.cpp)
target_link_libraries(simvis_decode PUBLIC simvis_any_picture PkgConfig::draco OpenEXR::OpenEXR)
simvis_helper_program(simvis-decode ${helper}/decode/decode_main.cpp simvis_decode)

simvis_import_program(mesh "PkgConfig::assimp;PkgConfig::liblzf;PkgConfig::libzstd;ZLIB::ZLIB" ${helper}/assimp_*.cpp ${helper}/clouds/*.cpp ${helper}/collada/*.cpp
                      ${helper}/meshes/*.cpp ${helper}/mesh_reader.cpp ${helper}/back_to_back.cpp ${helper}/part_source.cpp
                      ${helper}/polygon.cpp ${helper}/utf16_text.cpp ${helper}/vertex_numbers.cpp)
if(Coin_FOUND)
  simvis_import_program(inventor Coin::Coin ${helper}/inventor/*.cpp)
  target_link_libraries(simvis_import_inventor PUBLIC simvis_any_picture)
endif()

# USD and xacro are read in Python, where it has the packages for that: scripts, and a library by which they limit their
# process. Python loads it, which has no sanitizer.
add_library(simvis-python-limits MODULE ${helper}/usd/limits.cpp ${helper}/process_limits.cpp ${helper}/file_access.cpp
            ${helper}/system_calls.cpp)
target_include_directories(simvis-python-limits PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR})
target_compile_options(simvis-python-limits PRIVATE -fno-sanitize=all -U__SANITIZE_ADDRESS__)
target_link_options(simvis-python-limits PRIVATE -fno-sanitize=all)
set_target_properties(simvis-python-limits PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                      LIBRARY_OUTPUT_DIRECTORY ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/${SIMVIS_IMPORT_FOLDER})
install(TARGETS simvis-python-limits LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/${SIMVIS_IMPORT_FOLDER})
file(GLOB python_scripts CONFIGURE_DEPENDS ${helper}/*.py ${helper}/usd/*.py ${helper}/xacro/*.py)
set(python_copies)
foreach(script ${python_scripts})
  get_filename_component(name ${script} NAME)
  set(copy ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/${SIMVIS_IMPORT_FOLDER}/python/${name})
  add_custom_command(OUTPUT ${copy} COMMAND ${CMAKE_COMMAND} -E copy ${script} ${copy} DEPENDS ${script})
  list(APPEND python_copies ${copy})
endforeach()
add_custom_target(simvis_python_scripts DEPENDS ${python_copies})
add_dependencies(simvis simvis-python-limits simvis_python_scripts)
install(FILES ${python_scripts} DESTINATION ${CMAKE_INSTALL_LIBDIR}/${SIMVIS_IMPORT_FOLDER}/python)

# Compiles every GLSL file of shaders/ to SPIR-V at build time and embeds it as an array of words:
# shaders/mesh_depth.vert becomes `mesh_depth_vert` in "shaders/mesh_depth.vert.h" of the build tree.
find_program(GLSLANG_VALIDATOR glslangValidator REQUIRED)

function(simvis_embed_shaders target)
  file(GLOB shaders CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/shaders/*.vert ${PROJECT_SOURCE_DIR}/shaders/*.frag
       ${PROJECT_SOURCE_DIR}/shaders/*.comp)
  file(GLOB includes CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/shaders/*.h ${PROJECT_SOURCE_DIR}/shaders/*.glsl)
  foreach(shader IN LISTS shaders)
    get_filename_component(file ${shader} NAME)
    string(REPLACE "." "_" symbol ${file})
    set(output ${PROJECT_BINARY_DIR}/generated/shaders/${file}.h)
    add_custom_command(
      OUTPUT ${output}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/generated/shaders
      COMMAND ${GLSLANG_VALIDATOR} --quiet --target-env vulkan1.2 -I${PROJECT_SOURCE_DIR} --vn ${symbol} -o ${output} ${shader}
      DEPENDS ${shader} ${includes}
      COMMENT "Compiling shaders/${file}" VERBATIM)
    target_sources(${target} PRIVATE ${output})
    list(APPEND outputs ${output})
  endforeach()
  add_custom_target(simvis_shaders DEPENDS ${outputs})  # what a look at the sources alone needs first
endfunction()

# Compiles the GLSL files of shaders/ to SPIR-V at build time and embeds each as an array of words:
# shaders/mesh_depth.vert becomes `mesh_depth_vert` in "shaders/mesh_depth.vert.h" of the build tree.
find_program(GLSLANG_VALIDATOR glslangValidator REQUIRED)

# What is compiled from a file once more: its name, the file, and what is defined in addition.
set(simvis_shader_variants
    "mesh_color_shadowed.frag mesh_color.frag SHADOWED"
    "mesh_color_textured.frag mesh_color.frag TEXTURED"
    "mesh_color_textured_shadowed.frag mesh_color.frag TEXTURED SHADOWED"
    "mesh_color_mapped.frag mesh_color.frag MAPPED"
    "mesh_color_mapped_shadowed.frag mesh_color.frag MAPPED SHADOWED"
    "mesh_layer.frag mesh_color.frag LAYER"
    "mesh_layer_shadowed.frag mesh_color.frag LAYER SHADOWED"
    "mesh_layer_textured.frag mesh_color.frag LAYER TEXTURED"
    "mesh_layer_textured_shadowed.frag mesh_color.frag LAYER TEXTURED SHADOWED"
    "mesh_layer_mapped.frag mesh_color.frag LAYER MAPPED"
    "mesh_layer_mapped_shadowed.frag mesh_color.frag LAYER MAPPED SHADOWED"
    "mesh_color_mapped.vert mesh_color.vert MAPPED"
    "mesh_mask_textured.frag mesh_mask.frag TEXTURED"
    "mesh_mask_instance.frag mesh_mask.frag INSTANCE"
    "mesh_mask_instance_textured.frag mesh_mask.frag INSTANCE TEXTURED"
    "mesh_item_mask.frag mesh_mask.frag ITEM"
    "mesh_item_mask_textured.frag mesh_mask.frag ITEM TEXTURED"
    "mesh_shadow_mask.frag mesh_mask.frag SHADOW_MAP"
    "mesh_shadow_mask_textured.frag mesh_mask.frag SHADOW_MAP TEXTURED"
    "mesh_mask_instance.vert mesh_mask.vert INSTANCE"
    "mesh_item_mask.vert mesh_mask.vert ITEM"
    "resolve_pass_multisampled.comp resolve_pass.comp MULTISAMPLED")

function(simvis_embed_shaders target)
  set(folder ${PROJECT_SOURCE_DIR}/shaders)
  file(GLOB shaders CONFIGURE_DEPENDS RELATIVE ${folder} ${folder}/*.vert ${folder}/*.frag ${folder}/*.comp)
  file(GLOB includes CONFIGURE_DEPENDS ${folder}/*.h ${folder}/*.glsl)
  foreach(shader IN LISTS shaders)
    list(APPEND all "${shader} ${shader}")
  endforeach()
  foreach(variant IN LISTS all simvis_shader_variants)
    separate_arguments(variant)
    list(POP_FRONT variant name file)
    list(TRANSFORM variant PREPEND -D)
    string(REPLACE "." "_" symbol ${name})
    set(output ${PROJECT_BINARY_DIR}/generated/shaders/${name}.h)
    add_custom_command(
      OUTPUT ${output}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/generated/shaders
      COMMAND ${GLSLANG_VALIDATOR} --quiet --target-env vulkan1.2 -I${PROJECT_SOURCE_DIR} ${variant} --vn ${symbol} -o ${output}
              ${folder}/${file}
      DEPENDS ${folder}/${file} ${includes}
      COMMENT "Compiling shaders/${name}" VERBATIM)
    target_sources(${target} PRIVATE ${output})
    list(APPEND outputs ${output})
  endforeach()
  add_custom_target(simvis_shaders DEPENDS ${outputs})  # what a look at the sources alone needs first
endfunction()

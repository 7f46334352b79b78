// SPDX-License-Identifier: MIT
#include "scene/gltf/extensions.hpp"

#include <set>

namespace manylight {

Extension extension_kind(const std::string& name) {
    static const std::set<std::string> rendered = {"EXT_meshopt_compression",
                                                   "EXT_mesh_gpu_instancing",
                                                   "EXT_texture_webp",
                                                   "KHR_animation_pointer",
                                                   "KHR_draco_mesh_compression",
                                                   "KHR_lights_punctual",
                                                   "KHR_materials_emissive_strength",
                                                   "KHR_materials_ior",
                                                   "KHR_materials_pbrSpecularGlossiness",
                                                   "KHR_materials_specular",
                                                   "KHR_materials_unlit",
                                                   "KHR_materials_variants",
                                                   "KHR_mesh_quantization",
                                                   "KHR_meshopt_compression",
                                                   "KHR_node_visibility",
                                                   "KHR_texture_transform"};
    static const std::set<std::string> silent = {"AGI_articulations",
                                                 "AGI_stk_metadata",
                                                 "EXT_feature_metadata",
                                                 "EXT_instance_features",
                                                 "EXT_mesh_features",
                                                 "EXT_mesh_manifold",
                                                 "EXT_structural_metadata",
                                                 "FB_geometry_metadata",
                                                 "GODOT_single_root",
                                                 "GRIFFEL_bim_data",
                                                 "KHR_audio_emitter",
                                                 "KHR_implicit_shapes",
                                                 "KHR_interactivity",
                                                 "KHR_node_hoverability",
                                                 "KHR_node_selectability",
                                                 "KHR_physics_rigid_bodies",
                                                 "KHR_xmp",
                                                 "KHR_xmp_json_ld",
                                                 "MOZ_hubs_components",
                                                 "MSFT_audio_emitter",
                                                 "MSFT_collision_mesh",
                                                 "MSFT_physics",
                                                 "OMI_audio_emitter",
                                                 "OMI_collider",
                                                 "OMI_physics_body",
                                                 "OMI_physics_shape",
                                                 "VRM",
                                                 "VRMC_node_constraint",
                                                 "VRMC_springBone",
                                                 "VRMC_vrm"};
    if (rendered.contains(name)) return Extension::rendered;
    if (silent.contains(name)) return Extension::silent;
    // KHR_materials_clearcoat, ADOBE_materials_thin_transparency, VRMC_materials_mtoon, ...
    if (name.find("_materials_") != std::string::npos ||
        name == "MSFT_packing_normalRoughnessMetallic" ||
        name == "MSFT_packing_occlusionRoughnessMetallic" || name == "KHR_texture_procedurals" ||
        name == "CESIUM_primitive_outline")
        return Extension::dropped;
    return Extension::unknown;
}

bool lets_light_through(const std::string& name) {
    return name == "KHR_materials_transmission" || name == "KHR_materials_volume" ||
           name == "KHR_materials_diffuse_transmission" ||
           name == "ADOBE_materials_thin_transparency";
}

}  // namespace manylight

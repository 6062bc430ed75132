#pragma once
// The makers of the writers, one a format, for the list in sequence_formats.cpp. Others
// use io/sequence_writer.h.

#include "taut/io/sequence_writer.h"

namespace taut::detail {

using SequenceMaker = std::unique_ptr<SequenceWriter>(SequenceOptions options,
                                                      std::vector<SequenceObject> objects);
SequenceMaker make_usd_sequence, make_obj_sequence, make_ply_sequence, make_pc2_sequence,
    make_mdd_sequence, make_vtk_sequence, make_gltf_sequence;

// An object's mesh at one frame.
TriangleMesh mesh_at(const SequenceObject& object, const ObjectFrame& frame);

}  // namespace taut::detail

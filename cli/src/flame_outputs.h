#pragma once
#include <span>

#include "mien/core/flame_model.h"
#include "vertex_outputs.h"

namespace mien {

/// Outputs of a model that gives FLAME parameters, without a FLAME model to make a face of them. Error
/// (Errc::usage): one that shows a face.
Status check_flame_outputs(std::span<const Output> outputs);

/// Writes the outputs of one take: .csv and .json hold the parameters, all others the vertices of the FLAME
/// model. Errors: those of flame_vertices() and of the writers.
Status write_flame_outputs(std::span<const Output> outputs, const Motion& parameters, const FlameModel& flame,
                           const VertexOptions& options, const VertexShow& show, ConsoleProgress& progress);

/// What to say of files that hold parameters and no face.
std::string flame_parameters_notice(const Motion& parameters);

}  // namespace mien

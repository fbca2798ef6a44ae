#pragma once
#include <filesystem>
#include <string>

#include "mien/base/result.h"
#include "mien/core/character.h"
#include "mien/datasets/blendshape_residuals.h"
#include "mien/datasets/templates.h"

namespace mien {

/// Faces of persons as BlendVOCA has them: a neutral face of each and what its blendshapes add (specification
/// of SAiD, section 10.2).
class PersonFaces {
 public:
  /// @param subset  file of the vertices that the residuals move; empty: all
  /// Errors: those of the readers; Errc::incompatible for residuals of another number of vertices and persons
  /// without a template.
  static Result<PersonFaces> load(const std::string& residuals, const std::string& templates,
                                  const std::string& subset);

  /// The person that a sequence is of: its name begins with that person's ("<person>_sentence07"), or it lies
  /// in a folder of that name. Error (Errc::incompatible): none.
  [[nodiscard]] Result<std::string> person_of(const std::filesystem::path& sequence) const;
  /// The face of a person with its shapes, in the units of the data set; no triangles. @pre one that
  /// person_of() named
  [[nodiscard]] Character face(const std::string& person) const;

 private:
  std::map<std::string, ShapeResiduals> residuals_;
  Templates neutral_;  // of the vertices that the residuals move
};

}  // namespace mien

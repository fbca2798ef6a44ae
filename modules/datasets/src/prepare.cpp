#include "mien/datasets/prepare.h"

#include "mien/base/contract.h"
#include "preparers.h"

namespace mien {

Result<PrepareReport> prepare_dataset(DatasetKind kind, const std::filesystem::path& raw,
                                      const std::filesystem::path& out, const PrepareOptions& options,
                                      Progress& progress) {
  switch (kind) {
    case DatasetKind::biwi:
    case DatasetKind::biwi_expressive:
      return datasets::prepare_biwi(kind, raw, out, options, progress);
    case DatasetKind::beat:
      return datasets::prepare_beat(raw, out, progress);
    case DatasetKind::vocaset:
      return datasets::prepare_vocaset(raw, out, options, progress);
    case DatasetKind::multiface:
      return datasets::prepare_multiface(raw, out, options, progress);
    case DatasetKind::uudamm:
      return datasets::prepare_uudamm(raw, out, options, progress);
    case DatasetKind::mead:
    case DatasetKind::mead_prior:
    case DatasetKind::mead_vertices:
      return Error{Errc::usage, std::string(dataset_layout(kind).name),
                   "is read as ProbTalk3D's programs prepare it; their HDF5 sources are not",
                   "Make wav/ and param/ (or vertices_npy/) with those programs: docs/datasets.md"};
  }
  contract(false, "prepare_dataset: unknown kind");
  return PrepareReport{};
}

}  // namespace mien

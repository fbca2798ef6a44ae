#include "mien/datasets/prepare.h"

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
    case DatasetKind::multiface:
    case DatasetKind::uudamm:
      break;
  }
  return Error{Errc::usage, std::string(dataset_layout(kind).name),
               "Mien does not prepare this data set from its raw form",
               "Bring it into wav/ and vertices_npy/ as docs/datasets.md says, then run: mien data check"};
}

}  // namespace mien

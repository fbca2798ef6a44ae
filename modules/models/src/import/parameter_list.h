#pragma once
#include <map>
#include <string>
#include <vector>

#include "mien/nn/parameters.h"

namespace mien {

/// Names and shapes of a network's parameters, from its sizes alone.
class ListParameters : public ParameterVisitor<ListParameters> {
 public:
  struct Entry {
    std::string name;
    Shape shape;
    bool is_optional = false;
  };
  std::vector<Entry> entries;

  template <class M>
  void matrix(std::string_view name, M&, std::int64_t out, std::int64_t in, Init) {
    add(name, {out, in});
  }
  template <class M>
  void convolution(std::string_view name, M&, std::int64_t out, std::int64_t in, std::int64_t kernel, Init) {
    add(name, {out, in, kernel});
  }
  template <class T>
  void tensor(std::string_view name, T&, const Shape& shape, Init) {
    add(name, shape);
  }
  template <class T>
  void optional(std::string_view name, T&, const Shape& shape, Init) {
    add(name, shape);
    entries.back().is_optional = true;
  }
  template <class T>
  void buffer(std::string_view name, T&, const Shape& shape) {
    add(name, shape);
  }

 private:
  void add(std::string_view name, const Shape& shape) { entries.push_back({full_name(name), shape}); }
};

}  // namespace mien

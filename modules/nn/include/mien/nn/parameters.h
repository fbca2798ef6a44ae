#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mien {

/// How a parameter starts before training.
enum class Init {
  fan_in,  ///< uniform in +- 1/sqrt(inputs)
  zero,
  one,
  normal,       ///< N(0, 0.02), for embedding tables
  unit_normal,  ///< N(0, 1)
};

/// Every network has one `visit(v)`, which names its parameters. Loading, saving, initialising, optimising
/// and counting are visitors derived from this class by `Self`, which receives:
///
///   self.matrix(name, Operations<T>::Matrix&, out, in, init)
///   self.convolution(name, Operations<T>::Matrix&, out, in, kernel, init)   stored as [out, in, kernel]
///   self.tensor(name, T&, shape, init)
///   self.optional(name, T&, shape, init)   as tensor(), but a file may lack it; the slot then stays as it is
///   self.buffer(name, T&, shape)         measured, not trained: statistics
///
/// Names are joined with dots: scope("gru", g) visits g's parameters as "gru.<name>".
template <class Self>
class ParameterVisitor {
 public:
  template <class Module>
  void scope(std::string_view name, Module& module) {
    const std::size_t length = prefix_.size();
    prefix_ += name;
    prefix_ += '.';
    module.visit(static_cast<Self&>(*this));
    prefix_.resize(length);
  }
  template <class Module>
  void scope(std::string_view name, std::vector<Module>& modules) {
    for (std::size_t i = 0; i < modules.size(); ++i) {
      std::string element(name);  // not a chain of +, at which GCC 12 gives false alarms
      element.append(1, '.').append(std::to_string(i));
      scope(element, modules[i]);
    }
  }
  template <class T, class I>
  void optional(std::string_view name, T& slot, const std::vector<std::int64_t>& shape, I init) {
    static_cast<Self&>(*this).tensor(name, slot, shape, init);
  }

 protected:
  [[nodiscard]] std::string full_name(std::string_view name) const { return prefix_ + std::string(name); }

 private:
  std::string prefix_;
};

using Shape = std::vector<std::int64_t>;

}  // namespace mien

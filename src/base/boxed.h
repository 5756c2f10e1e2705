#pragma once
/// A value in a box of its own, copied with it. A struct can have one whose type its header only declares, if the
/// struct's own special members are defined where the type is known.
#include <memory>

namespace talus {

template <class T>
class Boxed {
 public:
  Boxed() : value_(std::make_unique<T>()) {}
  Boxed(const Boxed &other) : value_(std::make_unique<T>(*other)) {}
  Boxed &operator=(const Boxed &other) {
    *value_ = *other;
    return *this;
  }
  ~Boxed() = default;

  T &operator*() { return *value_; }
  const T &operator*() const { return *value_; }
  T *operator->() { return value_.get(); }
  const T *operator->() const { return value_.get(); }

 private:
  std::unique_ptr<T> value_;  ///< never empty
};

}  // namespace talus

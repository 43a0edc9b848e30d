// A folder of a test's own, removed with all in it.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace least::server::test {

class TemporaryFolder {
 public:
  TemporaryFolder() : name_((std::filesystem::temp_directory_path() / "least-XXXXXX").string()) {
    if (!::mkdtemp(name_.data())) throw std::runtime_error("cannot make " + name_);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  ~TemporaryFolder() { std::filesystem::remove_all(name_); }

  const std::string& name() const { return name_; }
  /// Of a file in it, whether or not there is one.
  std::string path(const std::string& file) const { return name_ + '/' + file; }

 private:
  std::string name_;
};

}  // namespace least::server::test

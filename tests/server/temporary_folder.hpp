// A folder for one test, removed with its contents at the end.
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
  /// path() returns the path of a file in the folder, whether or not the file exists.
  std::string path(const std::string& file) const { return name_ + '/' + file; }

 private:
  std::string name_;
};

}  // namespace least::server::test

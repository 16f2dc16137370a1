#include <lodestone/io/file.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

namespace lodestone {
namespace {

using detail::text;

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
constexpr int kMostLinks = 40;                  // where Linux gives up, too
constexpr std::size_t kKeptBytesOfAName = 100;  // with the tag, below the 255 of most file systems and the 143 of some

std::string system_reason(int error) { return std::generic_category().message(error); }

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  bool valid() const { return fd_ >= 0; }
  int get() const { return fd_; }
  /// Closes now, where the caller has to know whether that worked: some file systems report a full disk only here.
  int close() { return ::close(std::exchange(fd_, -1)); }

 private:
  int fd_;
};

auto unreadable(const std::filesystem::path& path, int error) {
  return fail(ErrorCode::Unreadable, text("cannot read '", path, "': ", system_reason(error)));
}

auto not_written(const std::filesystem::path& path, int error) {
  return fail(ErrorCode::NotWritten, text("cannot write '", path, "': ", system_reason(error)));
}

/// Returns 0, or the system's error number.
int write_all(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), std::min(bytes.size(), kBlockBytes));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

/// Pipes and devices have no name to rename over; bytes go straight through.
bool is_special(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

Result<void> write_through(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.valid()) return not_written(path, errno);
  if (const int error = write_all(file.get(), bytes)) return not_written(path, error);
  if (file.close() != 0) return not_written(path, errno);
  return {};
}

/// A new file beside `path` under a name that no other writer, in this process or another, uses at this moment.
struct TemporaryFile {
  std::filesystem::path name;
  int fd = -1;  ///< −1: none could be made, errno says why
};

TemporaryFile open_temporary(const std::filesystem::path& path) {
  TemporaryFile file;
  for (int serial = 0; serial < 1000; ++serial) {
    file.name = stand_in_name(path, text('.', ::getpid(), '-', serial, ".tmp"));
    file.fd = ::open(file.name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file.fd >= 0 || errno != EEXIST) break;
  }
  return file;
}

/// Returns 0, or the system's error number.
int write_flush_rename(Descriptor file, const std::filesystem::path& name, const std::filesystem::path& path,
                       std::span<const std::byte> bytes) {
  if (const int error = write_all(file.get(), bytes)) return error;
  if (::fsync(file.get()) != 0) return errno;
  if (file.close() != 0) return errno;
  return ::rename(name.c_str(), path.c_str()) == 0 ? 0 : errno;
}

}  // namespace

Result<std::vector<std::byte>> read_file(const std::filesystem::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.valid()) return unreadable(path, errno);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) return unreadable(path, errno);

  std::vector<std::byte> bytes;
  if (S_ISREG(status.st_mode)) bytes.reserve(static_cast<std::size_t>(status.st_size) + 1);
  for (;;) {  // Until the end, not for st_size bytes: pipes have no size, and files grow.
    const std::size_t used = bytes.size();
    bytes.resize(used < bytes.capacity() ? bytes.capacity() : used + kBlockBytes);
    const ssize_t count = ::read(file.get(), bytes.data() + used, bytes.size() - used);
    const int error = errno;
    bytes.resize(used + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (count < 0 && error == EINTR) continue;
    if (count < 0) return unreadable(path, error);
    if (count == 0) return bytes;
  }
}

Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  if (is_special(path)) return write_through(path, bytes);
  LODESTONE_TRY(const std::filesystem::path target, follow_links(path));
  const TemporaryFile temporary = open_temporary(target);
  if (temporary.fd < 0) return not_written(path, errno);
  const int error = write_flush_rename(Descriptor(temporary.fd), temporary.name, target, bytes);
  if (error == 0) return {};
  ::unlink(temporary.name.c_str());
  return not_written(path, error);
}

Result<std::filesystem::path> follow_links(const std::filesystem::path& path) {
  std::filesystem::path target = path;
  for (int i = 0; i < kMostLinks; ++i) {
    std::error_code error;
    if (!std::filesystem::is_symlink(target, error)) return target;
    const std::filesystem::path next = std::filesystem::read_symlink(target, error);
    if (error) return not_written(path, error.value());
    target = target.parent_path() / next;  // which is `next` alone where that begins at the root
  }
  return not_written(path, ELOOP);
}

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = detail::lower_case(path.extension().string());
  if (!extension.empty()) extension.erase(0, 1);
  return extension;
}

std::filesystem::path stand_in_name(const std::filesystem::path& path, std::string_view tag) {
  std::filesystem::path name = path;
  return name.replace_filename(text('.', path.filename().string().substr(0, kKeptBytesOfAName), tag));
}

}  // namespace lodestone

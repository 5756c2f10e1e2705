/* Faults of file operations, for tests: a library for LD_PRELOAD. It counts the operations of a process on files below
   TALUS_FAULT_FOLDER (a list parted by ':') and lets operation number TALUS_FAULT_AT fail in the way TALUS_FAULT_KIND:

     ENOSPC, EIO, EACCES, EDQUOT   the operation returns this error; nothing is done
     short                         a write or read passes half of the bytes (where there are several), and says so
     kill                          a write passes half of the bytes, then the process gets SIGKILL; other operations: before
                                   they are done

   TALUS_FAULT_REPEAT=1: all later operations of the same name fail too, as on a disk that stays full.
   TALUS_FAULT_LOG: a file to which each operation is written as "NUMBER NAME PATH". */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_long operations;

static const char *setting(const char *name) {
  const char *value = getenv(name);
  return value ? value : "";
}

/* Does the path lie below one of the folders? */
static int watched(const char *path) {
  if (!path) return 0;
  char whole[4096];
  if (path[0] != '/') {
    if (!getcwd(whole, sizeof whole - 1)) return 0;
    strcat(whole, "/");
    strncat(whole, path, sizeof whole - strlen(whole) - 1);
    path = whole;
  }
  const char *folders = setting("TALUS_FAULT_FOLDER");
  while (*folders) {
    const size_t length = strcspn(folders, ":");
    if (length && !strncmp(path, folders, length)) return 1;
    folders += length + (folders[length] == ':');
  }
  return 0;
}

static const char *path_of(int file, char *buffer, size_t size) {
  char link[64];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, buffer, size - 1);
  if (length <= 0 || *buffer != '/') return NULL; /* a pipe or a socket has no path */
  buffer[length] = 0;
  return buffer;
}

enum fault { none, error, shortened, killed };

/* Counts an operation; what is to happen to it. `errno` is set for an error. */
static enum fault fault_of(const char *name, const char *path) {
  static _Thread_local int inside;
  static char broken[32];
  if (inside || !watched(path)) return none;
  inside = 1;
  const int before = errno;
  const long number = ++operations;
  const char *log = setting("TALUS_FAULT_LOG");
  if (*log) {
    char line[4300];
    const int length = snprintf(line, sizeof line, "%ld %s %s\n", number, name, path);
    const int file = (int)syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND, 0600);
    if (file >= 0) (void)!syscall(SYS_write, file, line, (size_t)length), syscall(SYS_close, file);
  }
  const long at = atol(setting("TALUS_FAULT_AT"));
  if (number == at) strncpy(broken, name, sizeof broken - 1);
  const int hit = number == at || (*broken && atoi(setting("TALUS_FAULT_REPEAT")) && !strcmp(broken, name));
  inside = 0;
  errno = before;
  if (!hit || at <= 0) return none;
  const char *kind = setting("TALUS_FAULT_KIND");
  if (!strcmp(kind, "short")) return shortened;
  if (!strcmp(kind, "kill")) return killed;
  errno = !strcmp(kind, "ENOSPC") ? ENOSPC : !strcmp(kind, "EACCES") ? EACCES : !strcmp(kind, "EDQUOT") ? EDQUOT : EIO;
  return error;
}

static void die(void) {
  kill(getpid(), SIGKILL);
  for (;;) pause();
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

/* Operations on paths: 0 or -1. */
#define ON_PATH(name, declaration, path, ...)                  \
  int name declaration {                                       \
    const enum fault fault = fault_of(#name, path);            \
    if (fault == killed) die();                                \
    if (fault == error) return -1;                             \
    return REAL(name)(__VA_ARGS__);                            \
  }
ON_PATH(rename, (const char *from, const char *to), to, from, to)
ON_PATH(unlink, (const char *path), path, path)
ON_PATH(remove, (const char *path), path, path)
ON_PATH(mkdir, (const char *path, mode_t mode), path, path, mode)

/* Operations on open files: 0 or -1. A failing close still closes, as on Linux. */
int fsync(int file) {
  char path[4096];
  const enum fault fault = fault_of("fsync", path_of(file, path, sizeof path));
  if (fault == killed) die();
  return fault == error ? -1 : REAL(fsync)(file);
}
int close(int file) {
  char path[4096];
  const enum fault fault = fault_of("close", path_of(file, path, sizeof path));
  const int cause = errno;
  if (fault == killed) die();
  const int status = REAL(close)(file);
  if (fault == error) errno = cause;
  return fault == error ? -1 : status;
}

/* Opening. */
#define OPEN(name)                                             \
  int name(const char *path, int flags, ...) {                 \
    va_list arguments;                                         \
    va_start(arguments, flags);                                \
    const mode_t mode = va_arg(arguments, mode_t);             \
    va_end(arguments);                                         \
    const enum fault fault = fault_of("open", path);           \
    if (fault == killed) die();                                \
    if (fault == error) return -1;                             \
    return REAL(open)(path, flags, mode);                      \
  }
OPEN(open)
OPEN(open64)
#define FOPEN(name)                                            \
  FILE *name(const char *path, const char *mode) {             \
    const enum fault fault = fault_of("fopen", path);          \
    if (fault == killed) die();                                \
    if (fault == error) return NULL;                           \
    return REAL(fopen)(path, mode);                            \
  }
FOPEN(fopen)
FOPEN(fopen64)

/* Bytes. */
ssize_t write(int file, const void *bytes, size_t count) {
  char path[4096];
  const enum fault fault = fault_of("write", path_of(file, path, sizeof path));
  const size_t part = fault == shortened || fault == killed ? (count + 1) / 2 : count;
  if (fault == error) return -1;
  const ssize_t written = REAL(write)(file, bytes, part);
  if (fault == killed) die();
  return written;
}
ssize_t writev(int file, const struct iovec *pieces, int count) {
  char path[4096];
  const enum fault fault = fault_of("write", path_of(file, path, sizeof path));
  if (fault == error) return -1;
  if (fault == none) return REAL(writev)(file, pieces, count);
  ssize_t written = 0;
  for (int i = 0; i < count && !written; ++i)  /* of the first piece that has any, one half */
    if (pieces[i].iov_len) written = REAL(write)(file, pieces[i].iov_base, (pieces[i].iov_len + 1) / 2);
  if (fault == killed) die();
  return written;
}
ssize_t read(int file, void *bytes, size_t count) {
  char path[4096];
  const enum fault fault = fault_of("read", path_of(file, path, sizeof path));
  if (fault == killed) die();
  if (fault == error) return -1;
  return REAL(read)(file, bytes, fault == shortened ? (count + 1) / 2 : count);
}
#define PREAD(name)                                                               \
  ssize_t name(int file, void *bytes, size_t count, off_t offset) {               \
    char path[4096];                                                              \
    const enum fault fault = fault_of("read", path_of(file, path, sizeof path));  \
    if (fault == killed) die();                                                   \
    if (fault == error) return -1;                                                \
    return REAL(pread)(file, bytes, fault == shortened ? (count + 1) / 2 : count, offset); \
  }
PREAD(pread)
PREAD(pread64)

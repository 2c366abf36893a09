/* Preloaded into a process, this fails the n-th call that writes below the folder FAULT_ROOT, as a full disk does. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#define MOST_FILES 65536
static char watched[MOST_FILES];
static long calls = 0, failing = 0;

void fault_arm(long n) { calls = 0; failing = n; }
long fault_count(void) { return calls; }

static int below(const char *path) {
    const char *root = getenv("FAULT_ROOT");
    return root && path && strncmp(path, root, strlen(root)) == 0;
}

/* Count a call, and say whether it is the one that fails. */
static int fails(void) {
    if (__sync_add_and_fetch(&calls, 1) != failing) return 0;
    errno = ENOSPC;
    return 1;
}

static int watch(int fd, const char *path, int flags) {
    if (fd >= 0 && fd < MOST_FILES) watched[fd] = below(path) && (flags & (O_WRONLY | O_RDWR));
    return fd;
}

/* Whether a file descriptor is of a file below the folder; its number may since be a socket's. */
static int is_watched(int fd) {
    struct stat status;
    return fd >= 0 && fd < MOST_FILES && watched[fd] && fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
}

#define NEXT(name) static __typeof__(&name) next; if (!next) next = (__typeof__(&name))dlsym(RTLD_NEXT, #name)
#define MODE(flags) mode_t mode = 0; if ((flags) & (O_CREAT | O_TMPFILE)) { va_list rest; va_start(rest, flags); mode = va_arg(rest, mode_t); va_end(rest); }

int open(const char *path, int flags, ...) {
    NEXT(open); MODE(flags)
    if (below(path) && (flags & (O_WRONLY | O_RDWR)) && fails()) return -1;
    return watch(next(path, flags, mode), path, flags);
}
int open64(const char *path, int flags, ...) {
    NEXT(open64); MODE(flags)
    if (below(path) && (flags & (O_WRONLY | O_RDWR)) && fails()) return -1;
    return watch(next(path, flags, mode), path, flags);
}
int openat(int dir, const char *path, int flags, ...) {
    NEXT(openat); MODE(flags)
    if (below(path) && (flags & (O_WRONLY | O_RDWR)) && fails()) return -1;
    return watch(next(dir, path, flags, mode), path, flags);
}
int openat64(int dir, const char *path, int flags, ...) {
    NEXT(openat64); MODE(flags)
    if (below(path) && (flags & (O_WRONLY | O_RDWR)) && fails()) return -1;
    return watch(next(dir, path, flags, mode), path, flags);
}
int close(int fd) {
    NEXT(close);
    if (fd >= 0 && fd < MOST_FILES) watched[fd] = 0;
    return next(fd);
}
ssize_t write(int fd, const void *data, size_t size) {
    NEXT(write);
    return is_watched(fd) && fails() ? -1 : next(fd, data, size);
}
ssize_t pwrite(int fd, const void *data, size_t size, off_t at) {
    NEXT(pwrite);
    return is_watched(fd) && fails() ? -1 : next(fd, data, size, at);
}
ssize_t pwrite64(int fd, const void *data, size_t size, off64_t at) {
    NEXT(pwrite64);
    return is_watched(fd) && fails() ? -1 : next(fd, data, size, at);
}
ssize_t writev(int fd, const struct iovec *parts, int count) {
    NEXT(writev);
    return is_watched(fd) && fails() ? -1 : next(fd, parts, count);
}
int fsync(int fd) { NEXT(fsync); return is_watched(fd) && fails() ? -1 : next(fd); }
int fdatasync(int fd) { NEXT(fdatasync); return is_watched(fd) && fails() ? -1 : next(fd); }
int rename(const char *from, const char *to) { NEXT(rename); return below(to) && fails() ? -1 : next(from, to); }
int renameat(int a, const char *from, int b, const char *to) {
    NEXT(renameat);
    return below(to) && fails() ? -1 : next(a, from, b, to);
}
int link(const char *from, const char *to) { NEXT(link); return below(to) && fails() ? -1 : next(from, to); }
int linkat(int a, const char *from, int b, const char *to, int flags) {
    NEXT(linkat);
    return below(to) && fails() ? -1 : next(a, from, b, to, flags);
}
int mkdir(const char *path, mode_t mode) { NEXT(mkdir); return below(path) && fails() ? -1 : next(path, mode); }
int mkdirat(int dir, const char *path, mode_t mode) {
    NEXT(mkdirat);
    return below(path) && fails() ? -1 : next(dir, path, mode);
}

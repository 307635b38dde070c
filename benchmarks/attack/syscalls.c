/* System calls of a process that fail, end it, or are written down. Built and loaded by syscalls.py.

   Only calls on files under one folder count. `fault_arm` has the Nth call of a kind fail with an error number, or
   end the process by SIGKILL before it. `fault_log` writes every call that changes files to a descriptor.
   Reached are all calls through the C library's symbols, so those of HDF5, Arrow and Python alike. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

enum { OPEN, WRITE, FSYNC, RENAME, CLOSE, KINDS, ANY = KINDS };
enum { KILL = -1 };

static char prefix[PATH_MAX];
static size_t prefix_length;
static int wanted = -2, error_number, sticky, log_fd = -1;
static long nth, counts[KINDS + 1];
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static int inside(const char *path) {
    return prefix_length && path && strncmp(path, prefix, prefix_length) == 0;
}

static int file_of(int fd, char *path) {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t length = syscall(SYS_readlinkat, AT_FDCWD, link, path, PATH_MAX - 1);
    if (length < 0) return 0;
    path[length] = 0;
    return inside(path);
}

/* Whether this call is to fail; sets errno then. */
static int fails(int kind) {
    pthread_mutex_lock(&lock);
    long number = ++counts[kind];
    long all = ++counts[ANY];
    int hit = 0;
    if (wanted == kind || wanted == ANY) {
        long n = wanted == ANY ? all : number;
        hit = nth > 0 && (n == nth || (sticky && n > nth));
    }
    pthread_mutex_unlock(&lock);
    if (hit && error_number == KILL) kill(getpid(), SIGKILL);
    if (hit) errno = error_number;
    return hit;
}

static void say(const void *data, size_t length) {
    const char *at = data;
    while (length > 0) {
        ssize_t done = syscall(SYS_write, log_fd, at, length);
        if (done <= 0) abort();
        at += done;
        length -= done;
    }
}

/* One record: a line of fields separated by tabs, then `length` bytes of data. */
static void note(const char *what, const char *path, const char *other, long long number, const void *data,
                 size_t length) {
    if (log_fd < 0) return;
    char line[2 * PATH_MAX + 64];
    int size = snprintf(line, sizeof line, "%s\t%s\t%s\t%lld\t%zu\n", what, path, other, number, length);
    say(line, size);
    say(data, length);
}

void fault_arm(const char *folder, int kind, int error, long which, int forever) {
    prefix_length = strlen(folder);
    memcpy(prefix, folder, prefix_length + 1);
    wanted = kind, error_number = error, nth = which, sticky = forever;
    memset(counts, 0, sizeof counts);
}

/* A process that is started, not forked, by an armed one is armed too, and appends its counts when it ends. */
__attribute__((constructor)) static void begin(void) {
    const char *armed = getenv("SWAMP_ATTACK_ARMED");
    int kind, error, forever, end;
    long which;
    if (armed && sscanf(armed, "%d %d %ld %d %n", &kind, &error, &which, &forever, &end) == 4)
        fault_arm(armed + end, kind, error, which, forever);
}

__attribute__((destructor)) static void end(void) {
    const char *file = getenv("SWAMP_ATTACK_COUNTS");
    char line[256];
    int fd = file && prefix_length ? (int)syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_APPEND | O_CREAT, 0644) : -1;
    if (fd < 0) return;
    int size = 0;
    for (int kind = 0; kind <= KINDS; kind++)
        size += snprintf(line + size, sizeof line - size, "%ld%c", counts[kind], kind < KINDS ? ' ' : '\n');
    syscall(SYS_write, fd, line, size);
    syscall(SYS_close, fd);
}

void fault_log(int fd) { log_fd = fd; }

void fault_mark(const char *text) {
    pthread_mutex_lock(&lock);
    note("mark", text, "", 0, "", 0);
    pthread_mutex_unlock(&lock);
}

void fault_counts(long *out) { memcpy(out, counts, sizeof counts); }

#define REAL(name, ...) \
    static __typeof__(name) *real; \
    if (!real) real = (__typeof__(name) *)dlsym(RTLD_NEXT, #name)

static int opened(int (*real)(const char *, int, ...), const char *path, int flags, mode_t mode) {
    if (!inside(path)) return real(path, flags, mode);
    if (fails(OPEN)) return -1;
    pthread_mutex_lock(&lock);
    struct stat there;
    int is_new = (flags & O_CREAT) && stat(path, &there) != 0;
    int fd = real(path, flags, mode);
    int saved = errno;
    if (fd >= 0 && is_new) note("create", path, "", 0, "", 0);
    else if (fd >= 0 && (flags & O_TRUNC)) note("truncate", path, "", 0, "", 0);
    pthread_mutex_unlock(&lock);
    errno = saved;
    return fd;
}

#define MODE(flags) \
    mode_t mode = 0; \
    if ((flags) & (O_CREAT | O_TMPFILE)) { \
        va_list rest; \
        va_start(rest, flags); \
        mode = va_arg(rest, mode_t); \
        va_end(rest); \
    }

int open(const char *path, int flags, ...) {
    MODE(flags)
    REAL(open);
    return opened(real, path, flags, mode);
}

int open64(const char *path, int flags, ...) {
    MODE(flags)
    REAL(open64);
    return opened(real, path, flags, mode);
}

static int at_cwd(const char *path, int flags, ...) {
    MODE(flags)
    return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}

int openat(int folder, const char *path, int flags, ...) {
    MODE(flags)
    if (path[0] == '/') return opened(at_cwd, path, flags, mode);
    return (int)syscall(SYS_openat, folder, path, flags, mode);
}

int openat64(int folder, const char *path, int flags, ...) {
    MODE(flags)
    return openat(folder, path, flags, mode);
}

static ssize_t written(int fd, const void *data, size_t length, long long offset, int at_offset) {
    char path[PATH_MAX];
    if (!(prefix_length && file_of(fd, path)))
        return at_offset ? syscall(SYS_pwrite64, fd, data, length, offset) : syscall(SYS_write, fd, data, length);
    if (fails(WRITE)) return -1;
    pthread_mutex_lock(&lock);
    if (!at_offset) {
        int flags = fcntl(fd, F_GETFL);
        offset = (flags & O_APPEND) ? lseek(fd, 0, SEEK_END) : lseek(fd, 0, SEEK_CUR);
    }
    ssize_t done = at_offset ? syscall(SYS_pwrite64, fd, data, length, offset)
                             : syscall(SYS_write, fd, data, length);
    int saved = errno;
    if (done > 0) note("write", path, "", offset, data, done);
    pthread_mutex_unlock(&lock);
    errno = saved;
    return done;
}

ssize_t write(int fd, const void *data, size_t length) { return written(fd, data, length, 0, 0); }
ssize_t pwrite(int fd, const void *data, size_t length, off_t offset) {
    return written(fd, data, length, offset, 1);
}
ssize_t pwrite64(int fd, const void *data, size_t length, off64_t offset) {
    return written(fd, data, length, offset, 1);
}

ssize_t writev(int fd, const struct iovec *parts, int count) {
    char path[PATH_MAX];
    if (!(prefix_length && file_of(fd, path))) return syscall(SYS_writev, fd, parts, count);
    ssize_t total = 0;
    for (int i = 0; i < count; i++) {
        if (!parts[i].iov_len) continue;
        ssize_t done = write(fd, parts[i].iov_base, parts[i].iov_len);
        if (done < 0) return total ? total : -1;
        total += done;
        if ((size_t)done < parts[i].iov_len) break;
    }
    return total;
}

static int flushed(int fd, long call) {
    char path[PATH_MAX];
    if (!(prefix_length && file_of(fd, path))) return (int)syscall(call, fd);
    if (fails(FSYNC)) return -1;
    pthread_mutex_lock(&lock);
    int done = (int)syscall(call, fd);
    int saved = errno;
    if (done == 0) note("fsync", path, "", 0, "", 0);
    pthread_mutex_unlock(&lock);
    errno = saved;
    return done;
}

int fsync(int fd) { return flushed(fd, SYS_fsync); }
int fdatasync(int fd) { return flushed(fd, SYS_fdatasync); }

int ftruncate(int fd, off_t length) {
    char path[PATH_MAX];
    if (!(prefix_length && file_of(fd, path))) return (int)syscall(SYS_ftruncate, fd, length);
    if (fails(WRITE)) return -1;
    pthread_mutex_lock(&lock);
    int done = (int)syscall(SYS_ftruncate, fd, length);
    int saved = errno;
    if (done == 0) note("truncate", path, "", length, "", 0);
    pthread_mutex_unlock(&lock);
    errno = saved;
    return done;
}

int ftruncate64(int fd, off64_t length) { return ftruncate(fd, length); }

static int renamed(const char *from, const char *to, unsigned flags) {
    if (!inside(from) && !inside(to))
        return (int)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, flags);
    if (fails(RENAME)) return -1;
    pthread_mutex_lock(&lock);
    int done = (int)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, flags);
    int saved = errno;
    if (done == 0) note("rename", from, to, 0, "", 0);
    pthread_mutex_unlock(&lock);
    errno = saved;
    return done;
}

int rename(const char *from, const char *to) { return renamed(from, to, 0); }

int renameat(int a, const char *from, int b, const char *to) {
    if (from[0] == '/' && to[0] == '/') return renamed(from, to, 0);
    return (int)syscall(SYS_renameat2, a, from, b, to, 0);
}

static int removed(const char *path, int flags) {
    if (!inside(path)) return (int)syscall(SYS_unlinkat, AT_FDCWD, path, flags);
    pthread_mutex_lock(&lock);
    int done = (int)syscall(SYS_unlinkat, AT_FDCWD, path, flags);
    int saved = errno;
    if (done == 0) note("unlink", path, "", 0, "", 0);
    pthread_mutex_unlock(&lock);
    errno = saved;
    return done;
}

int unlink(const char *path) { return removed(path, 0); }
int rmdir(const char *path) { return removed(path, AT_REMOVEDIR); }

int mkdir(const char *path, mode_t mode) {
    if (!inside(path)) return (int)syscall(SYS_mkdirat, AT_FDCWD, path, mode);
    if (fails(OPEN)) return -1;
    pthread_mutex_lock(&lock);
    int done = (int)syscall(SYS_mkdirat, AT_FDCWD, path, mode);
    int saved = errno;
    if (done == 0) note("mkdir", path, "", 0, "", 0);
    pthread_mutex_unlock(&lock);
    errno = saved;
    return done;
}

int close(int fd) {
    char path[PATH_MAX];
    int ours = prefix_length && file_of(fd, path);
    int hit = ours && fails(CLOSE), saved = errno;
    int done = (int)syscall(SYS_close, fd);
    if (hit) errno = saved;
    return hit ? -1 : done;
}

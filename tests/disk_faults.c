/* Loaded before the C library (LD_PRELOAD): fails chosen calls on files below a folder. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/types.h>
#include <unistd.h>

static struct { char folder[4096]; long calls, first, last, renames; int error; } *plan;

/* Calls with a number from first to last, exclusive, fail with this error; 0: writes are halved. */
void fail_calls(const char *folder, long first, long last, int error) {
    if (!plan) plan = mmap(0, sizeof *plan, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    strncpy(plan->folder, folder, sizeof plan->folder - 1);
    plan->calls = plan->renames = 0; plan->first = first; plan->last = last; plan->error = error;
}

long calls_so_far(void) { return plan->calls; }
long renames_so_far(void) { return plan->renames; }

static int chosen(const char *name) {
    if (!plan || !*plan->folder || !strstr(name, plan->folder)) return 0;
    long call = __atomic_fetch_add(&plan->calls, 1, __ATOMIC_SEQ_CST);
    return plan->first <= call && call < plan->last;
}

static int chosen_open(int file) {
    char link[64], name[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t size = readlink(link, name, sizeof name - 1);
    if (size < 0) return 0;
    name[size] = 0;
    return chosen(name);
}

#define NEXT(result, name, ...) \
    static result (*next)(__VA_ARGS__); \
    if (!next) next = dlsym(RTLD_NEXT, name)
#define FAIL_IF_CHOSEN(choice) \
    if ((choice) && plan->error) { errno = plan->error; return -1; }

ssize_t write(int file, const void *data, size_t size) {
    NEXT(ssize_t, "write", int, const void *, size_t);
    if (chosen_open(file)) {
        if (plan->error) { errno = plan->error; return -1; }
        if (size > 1) size /= 2;
    }
    return next(file, data, size);
}
ssize_t pwrite64(int file, const void *data, size_t size, off64_t at) {
    NEXT(ssize_t, "pwrite64", int, const void *, size_t, off64_t);
    FAIL_IF_CHOSEN(chosen_open(file));
    return next(file, data, size, at);
}
ssize_t pwrite(int file, const void *data, size_t size, off_t at) {
    NEXT(ssize_t, "pwrite", int, const void *, size_t, off_t);
    FAIL_IF_CHOSEN(chosen_open(file));
    return next(file, data, size, at);
}
ssize_t sendfile64(int to, int from, off64_t *at, size_t size) {
    NEXT(ssize_t, "sendfile64", int, int, off64_t *, size_t);
    FAIL_IF_CHOSEN(chosen_open(to));
    return next(to, from, at, size);
}
int ftruncate64(int file, off64_t size) {
    NEXT(int, "ftruncate64", int, off64_t);
    FAIL_IF_CHOSEN(chosen_open(file));
    return next(file, size);
}
int fsync(int file) {
    NEXT(int, "fsync", int);
    FAIL_IF_CHOSEN(chosen_open(file));
    return next(file);
}
int close(int file) {
    NEXT(int, "close", int);
    int written = (fcntl(file, F_GETFL) & O_ACCMODE) != O_RDONLY;
    int fails = written && chosen_open(file), result = next(file);
    if (fails && plan->error) { errno = plan->error; return -1; }
    return result;
}
int rename(const char *from, const char *to) {
    NEXT(int, "rename", const char *, const char *);
    FAIL_IF_CHOSEN(chosen(to));
    int result = next(from, to);
    if (plan && *plan->folder && !result && strstr(to, plan->folder)) plan->renames++;
    return result;
}
int open64(const char *name, int flags, ...) {
    NEXT(int, "open64", const char *, int, ...);
    va_list more;
    va_start(more, flags);
    mode_t mode = flags & O_CREAT ? va_arg(more, mode_t) : 0;
    va_end(more);
    FAIL_IF_CHOSEN((flags & O_CREAT) && chosen(name));
    return next(name, flags, mode);
}

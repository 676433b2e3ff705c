/* A driver without a card: its memory is this processor's, every call is told, and a launch
   runs the program, if there is a loader for it (`card.py`), or calls what a test has said. */
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CALL(name, ...) \
    do { \
        tell(name, __VA_ARGS__); \
        if (failing_code && !strcmp(name, failing)) { \
            int code = failing_code; \
            failing_code = 0; \
            return code; \
        } \
    } while (0)

typedef void (*Kernel)(const char *entry, uint64_t parts, uint64_t first, uint64_t workers);
typedef uint64_t Address;
/* Return a program of a text, or 0 and what is wrong with it. */
typedef void *(*Loader)(const char *text, char *log);
/* Run it; return an error's code. */
typedef int (*Runner)(void *program, unsigned blocks, unsigned threads, const uint64_t *parameters);

static char told[1 << 20];
static size_t told_size;
static char failing[64];
static int failing_code;
static struct { Address address; size_t size; } pieces[4096];
static int pieces_used;
static size_t free_memory = 1 << 30;
static int depth, cards = 1, major = 9;
static Kernel kernel;
static Loader loader;
static Runner runner;
static char entries[64][256];
static int entry_count;

/* What is recorded: a launch, or memory to be set. */
typedef struct Work {
    void *function;
    unsigned blocks, threads;
    uint64_t parameters[3];
    Address at;
    unsigned char value;
    size_t size;
    struct Work *next;
} Work;
static int recording;
static Work *recorded, **last = &recorded;

static void tell(const char *name, const char *format, ...)
{
    va_list arguments;
    size_t left = sizeof told - told_size;
    told_size += snprintf(told + told_size, left, "%s ", name);
    va_start(arguments, format);
    told_size += vsnprintf(told + told_size, sizeof told - told_size, format, arguments);
    va_end(arguments);
    told_size += snprintf(told + told_size, sizeof told - told_size, "\n");
}

/* What tests ask of it. */
const char *fake_told(void) { return told; }
void fake_forget(void) { told_size = 0; told[0] = 0; }
void fake_fail(const char *name, int code) { strcpy(failing, name); failing_code = code; }
void fake_cards(int count, int capability) { cards = count; major = capability; }
void fake_memory(size_t size) { free_memory = size; }
void fake_kernel(Kernel function) { kernel = function; }
/* Run programs from now on, or, without a loader, no more. */
void card_programs(Loader load, Runner run)
{
    loader = load;
    runner = run;
    recording = 0;
}
int fake_depth(void) { return depth; }
int fake_pieces(void)
{
    int count = 0;
    for (int i = 0; i < 4096; i++) count += pieces[i].address != 0;
    return count;
}
/* Whether memory is the device's. */
int card_owns(Address address, size_t size)
{
    static int recent;
    for (int k = 0; k <= pieces_used; k++) {
        int i = k ? k - 1 : recent;
        if (pieces[i].address && pieces[i].address <= address &&
            address + size <= pieces[i].address + pieces[i].size) {
            recent = i;
            return 1;
        }
    }
    return 0;
}

int cuGetErrorName(int code, const char **text)
{
    *text = code == 2 ? "CUDA_ERROR_OUT_OF_MEMORY" : code == 218 ? "CUDA_ERROR_INVALID_PTX"
          : code == 700 ? "CUDA_ERROR_ILLEGAL_ADDRESS" : "CUDA_ERROR_OTHER";
    return 0;
}
int cuGetErrorString(int code, const char **text)
{
    *text = code == 700 ? "an illegal memory access was encountered" : "something is wrong";
    return 0;
}
int cuInit(unsigned flags) { CALL("cuInit", "%u", flags); return cards ? 0 : 100; }
int cuDriverGetVersion(int *version) { *version = 13000; return 0; }
int cuDeviceGetCount(int *count) { *count = cards; return 0; }
int cuDeviceGet(int *device, int ordinal) { *device = 40 + ordinal; return 0; }
int cuDeviceGetName(char *name, int size, int device)
{
    snprintf(name, size, "Fake %d", device);
    return 0;
}
int cuDeviceGetAttribute(int *value, int what, int device)
{
    (void)device;
    *value = what == 75 ? major : 0;
    return 0;
}
int cuDeviceTotalMem_v2(size_t *size, int device) { (void)device; *size = 1 << 30; return 0; }
int cuDevicePrimaryCtxRetain(void **context, int device)
{
    CALL("cuDevicePrimaryCtxRetain", "%d", device);
    *context = (void *)0x77;
    return 0;
}
int cuCtxPushCurrent_v2(void *context) { depth++; return context == (void *)0x77 ? 0 : 201; }
int cuCtxPopCurrent_v2(void **context) { depth--; *context = (void *)0x77; return 0; }
int cuMemGetInfo_v2(size_t *left, size_t *total) { *left = free_memory; *total = 1 << 30; return 0; }
int cuMemAlloc_v2(Address *address, size_t size)
{
    CALL("cuMemAlloc", "%zu", size);
    if (size > free_memory) return 2;
    for (int i = 0; i < 4096; i++)
        if (!pieces[i].address) {
            if (i >= pieces_used) pieces_used = i + 1;
            pieces[i].size = size;
            pieces[i].address = *address = (Address)aligned_alloc(256, (size + 255) / 256 * 256);
            memset((void *)*address, 0xcd, size);
            free_memory -= size;
            return 0;
        }
    return 2;
}
int cuMemFree_v2(Address address)
{
    CALL("cuMemFree", "");
    for (int i = 0; i < 4096; i++)
        if (pieces[i].address && pieces[i].address == address) {
            free_memory += pieces[i].size;
            pieces[i].address = 0;
            free((void *)address);
            return depth ? 0 : 201;
        }
    return 1;
}
int cuMemcpyHtoD_v2(Address to, const void *from, size_t size)
{
    CALL("cuMemcpyHtoD", "%zu", size);
    if (!depth || !card_owns(to, size)) return 700;
    memcpy((void *)to, from, size);
    return 0;
}
int cuMemcpyDtoH_v2(void *to, Address from, size_t size)
{
    CALL("cuMemcpyDtoH", "%zu", size);
    if (!depth || !card_owns(from, size)) return 700;
    memcpy(to, (void *)from, size);
    return 0;
}
static int do_work(const Work *work)
{
    const uint64_t *given = work->parameters;
    if (!work->function) memset((void *)work->at, work->value, work->size);
    else if (runner) return runner(work->function, work->blocks, work->threads, given);
    else if (kernel) kernel(work->function, given[0], given[1], given[2]);
    return 0;
}
/* Do it, or record it. */
static int done(Work work, void *stream)
{
    if (!recording || stream != (void *)0x55) return do_work(&work);
    *last = malloc(sizeof work);
    **last = work;
    last = &(*last)->next;
    return 0;
}
int cuMemsetD8Async(Address at, unsigned char value, size_t size, void *stream)
{
    CALL("cuMemsetD8Async", "%zu stream %p", size, stream);
    if (!depth || !card_owns(at, size)) return 700;
    return done((Work){.at = at, .value = value, .size = size}, stream);
}
int cuModuleLoadDataEx(void **module, const char *text, unsigned count, const int *options,
                       void **values)
{
    CALL("cuModuleLoadDataEx", "%u", count);
    if (loader) {
        char log[8192] = "";
        *module = loader(text, log);
        for (unsigned i = 0; i < count; i++)
            if (options[i] == 5) strcpy(values[i], log);
        return *module ? 0 : 218;
    }
    const char *entry = strstr(text, ".entry ");
    if (!entry) {
        for (unsigned i = 0; i < count; i++)
            if (options[i] == 5) strcpy(values[i], "ptxas fatal: no entry\n");
        return 218;
    }
    sscanf(entry, ".entry %255[^( \n]", entries[entry_count]);
    *module = entries[entry_count++];
    return 0;
}
int cuModuleGetFunction(void **function, void *module, const char *name)
{
    CALL("cuModuleGetFunction", "%s", name);
    *function = module;
    return loader ? 0 : strcmp(module, name) ? 500 : 0;
}
int cuFuncGetAttribute(int *value, int what, void *function)
{
    (void)function;
    *value = what == 4 ? 40 : 0;
    return 0;
}
int cuFuncSetAttribute(void *function, int what, int value)
{
    (void)function;
    CALL("cuFuncSetAttribute", "%d %d", what, value);
    return 0;
}
int cuLaunchKernel(void *function, unsigned gx, unsigned gy, unsigned gz, unsigned bx, unsigned by,
                   unsigned bz, unsigned shared, void *stream, void **given, void **extra)
{
    uint64_t workers = *(uint64_t *)given[2];
    CALL("cuLaunchKernel", "grid %u %u %u block %u %u %u shared %u stream %p workers %lu",
         gx, gy, gz, bx, by, bz, shared, stream, (unsigned long)workers);
    if (!depth || extra) return 1;
    Work work = {.function = function, .blocks = gx, .threads = bx};
    for (int i = 0; i < 3; i++) work.parameters[i] = *(uint64_t *)given[i];
    return done(work, stream);
}
int cuStreamCreate(void **stream, unsigned flags)
{
    CALL("cuStreamCreate", "%u", flags);
    *stream = (void *)0x55;
    return 0;
}
int cuStreamDestroy_v2(void *stream) { CALL("cuStreamDestroy", "%p", stream); return 0; }
int cuStreamSynchronize(void *stream) { CALL("cuStreamSynchronize", "%p", stream); return 0; }
int cuStreamWaitEvent(void *stream, void *event, unsigned flags)
{
    CALL("cuStreamWaitEvent", "%p %p %u", stream, event, flags);
    return 0;
}
int cuStreamBeginCapture_v2(void *stream, int mode)
{
    CALL("cuStreamBeginCapture", "%p %d", stream, mode);
    recording = 1;
    return 0;
}
int cuStreamEndCapture(void *stream, void **graph)
{
    CALL("cuStreamEndCapture", "%p", stream);
    *graph = recorded ? recorded : (void *)0x66;
    recording = 0;
    recorded = NULL;
    last = &recorded;
    return 0;
}
int cuGraphInstantiateWithFlags(void **executable, void *graph, unsigned long long flags)
{
    CALL("cuGraphInstantiate", "%llu", flags);
    *executable = graph;
    return 0;
}
int cuGraphLaunch(void *executable, void *stream)
{
    CALL("cuGraphLaunch", "stream %p", stream);
    int code = 0;
    for (Work *work = executable; work != (void *)0x66 && work && !code; work = work->next)
        code = do_work(work);
    return code;
}
int cuGraphDestroy(void *graph) { CALL("cuGraphDestroy", ""); return graph ? 0 : 1; }
int cuGraphExecDestroy(void *executable)
{
    CALL("cuGraphExecDestroy", "");
    for (Work *work = executable, *next; work != (void *)0x66 && work; work = next) {
        next = work->next;
        free(work);
    }
    return 0;
}
int cuEventCreate(void **event, unsigned flags)
{
    CALL("cuEventCreate", "%u", flags);
    *event = (void *)0x99;
    return 0;
}
int cuEventRecord(void *event, void *stream) { CALL("cuEventRecord", "%p %p", event, stream); return 0; }
int cuEventSynchronize(void *event) { CALL("cuEventSynchronize", "%p", event); return 0; }
int cuEventElapsedTime(float *passed, void *from, void *to)
{
    CALL("cuEventElapsedTime", "%p %p", from, to);
    *passed = 250.0f;
    return 0;
}
int cuEventDestroy_v2(void *event) { CALL("cuEventDestroy", "%p", event); return 0; }

/* Runs programs in PTX, one warp of 32 threads after another. Threads that part at a branch go one
   party after the other until they meet. What each instruction does is in `instructions.inc`, made
   of `instructions.py`. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define LANES 32
#define CALLS 16
#define PARTIES 256
#define EXIT (-1)

typedef struct {
    int32_t code, leads, guard, wanted, d, a, b, c, meet, unused;
    int64_t offset;
} Instruction;

/* A register, and what it holds: a constant, or the offset of an address. */
typedef struct { int64_t reg, value; } Place;

/* See `program.py`. */
typedef struct {
    const Instruction *instructions;
    const int32_t *targets;
    const Place *constants, *shared, *local, *data;
    const int64_t *special, *parameters;
    int64_t constants_count, shared_count, local_count, data_count;
    int64_t start, registers, shared_size, local_size;
    const char *content;
    int64_t content_size;
    /* Of each instruction: how often a warp did it, with how many threads, and how many pieces of
       32 bytes of memory it touched. */
    uint64_t *turns, *threads, *pieces;
} Program;

/* Threads that go together, from one instruction to where they meet others; `EXIT`: to the end of
   the function that they began in, which has been called `home` times from another. */
typedef struct { uint32_t mask; int32_t at, meet, depth, home; } Party;

typedef struct {
    const Program *program;
    int (*owns)(uint64_t address, size_t size);  /* whether memory is the card's */
    uint64_t (*regs)[LANES];
    int32_t back[CALLS][LANES];
    Party parties[PARTIES];  /* the last goes on; those before wait for it */
    int count;
    uint64_t chance;  /* which of two parties goes first; 0: always the same */
    char *shared, *local;
    const char *wrong;
    int32_t wrong_at;
    uint64_t wrong_address;
} Warp;

static inline double f64(uint64_t bits) { double x; memcpy(&x, &bits, 8); return x; }
static inline float f32(uint64_t bits)
{
    uint32_t low = (uint32_t)bits;
    float x;
    memcpy(&x, &low, 4);
    return x;
}
static inline uint64_t of_f64(double x) { uint64_t bits; memcpy(&bits, &x, 8); return bits; }
static inline uint64_t of_f32(float x) { uint32_t bits; memcpy(&bits, &x, 4); return bits; }

#define EXTREMES(kind, type) \
    static inline uint64_t max_##kind(uint64_t a, uint64_t b) \
    { \
        type x = kind(a), y = kind(b); \
        return x > y ? a : y > x ? b : x == y ? a & b : x == x ? a : b; \
    } \
    static inline uint64_t min_##kind(uint64_t a, uint64_t b) \
    { \
        type x = kind(a), y = kind(b); \
        return x < y ? a : y < x ? b : x == y ? a | b : x == x ? a : b; \
    }
EXTREMES(f64, double)
EXTREMES(f32, float)

/* Whole numbers of others: what is too large becomes the largest, what is none becomes 0. */
#define WHOLE(kind, type, low, high) \
    static inline uint64_t kind##_of(double x) \
    { \
        if (x != x) return 0; \
        if (x <= (double)low) return (uint64_t)(type)low; \
        if (x >= (double)high) return (uint64_t)(type)high; \
        return (uint64_t)(type)x; \
    }
WHOLE(s64, int64_t, INT64_MIN, INT64_MAX)
WHOLE(u64, uint64_t, 0, UINT64_MAX)
static inline uint64_t s32_of(double x)
{
    if (x != x) return 0;
    return (uint32_t)(int32_t)(x <= INT32_MIN ? INT32_MIN : x >= INT32_MAX ? INT32_MAX : x);
}
static inline uint64_t u32_of(double x)
{
    if (x != x || x <= 0) return 0;
    return x >= UINT32_MAX ? UINT32_MAX : (uint32_t)x;
}

/* A field of bits, without a sign. */
static inline uint64_t bits_of(uint64_t value, uint64_t from, uint64_t count)
{
    uint64_t bits = (from & 255) < 64 ? value >> (from & 255) : 0;
    return (count & 255) < 64 ? bits & ((1ull << (count & 255)) - 1) : bits;
}
/* The same, with the sign that its highest bit is. */
static inline uint64_t signed_bits_of(uint64_t value, uint64_t from, uint64_t count)
{
    uint64_t bits = bits_of(value, from, count), sign = 1ull << (((count & 255) - 1) & 63);
    return (count & 255) ? (bits ^ sign) - sign : 0;
}

static int may_use(Warp *warp, uint64_t address, size_t size, int32_t at)
{
    const Program *p = warp->program;
    if (address % size) warp->wrong = "a misaligned address";
    else if (address >= (uint64_t)warp->shared &&
             address + size <= (uint64_t)warp->shared + p->shared_size) return 1;
    else if (address >= (uint64_t)warp->local &&
             address + size <= (uint64_t)warp->local + LANES * p->local_size) return 1;
    else if (address >= (uint64_t)p->content &&
             address + size <= (uint64_t)p->content + p->content_size) return 1;
    else if (warp->owns(address, size)) return 1;
    else warp->wrong = "an address that is not the program's";
    warp->wrong_at = at;
    warp->wrong_address = address;
    return 0;
}

static int pieces_of(const uint64_t *addresses, uint32_t mask, int64_t offset)
{
    uint64_t seen[LANES];
    int count = 0;
    for (int i = 0; i < LANES; i++) {
        if (!(mask >> i & 1)) continue;
        uint64_t piece = (addresses[i] + offset) / 32;
        int k = 0;
        while (k < count && seen[k] != piece) k++;
        if (k == count) seen[count++] = piece;
    }
    return count;
}

#define EACH(expression) \
    for (int i = 0; i < LANES; i++) { \
        uint64_t a = A[i], b = B[i], c = C[i]; \
        (void)a, (void)b, (void)c; \
        D[i] = (D[i] & ~full[i]) | ((expression) & full[i]); \
    } \
    break;

#define EACH_PLACE(type) \
    program->pieces[at] += pieces_of(A, mask, o->offset); \
    for (int i = 0; i < LANES; i++) \
        if (mask >> i & 1 && !may_use(warp, A[i] + o->offset, sizeof(type), at)) return; \
    for (int i = 0; i < LANES; i++) \
        if (mask >> i & 1)
#define LOAD(type) \
    EACH_PLACE(type) { D[i] = (uint64_t)*(type *)(A[i] + o->offset); } \
    break;
#define STORE(type) \
    EACH_PLACE(type) { *(type *)(A[i] + o->offset) = (type)B[i]; } \
    break;
#define ATOMIC(type, expression) \
    EACH_PLACE(type) \
    { \
        type *place = (type *)(A[i] + o->offset), old = *place, value = (type)B[i]; \
        *place = (expression); \
        D[i] = (uint64_t)old; \
    } \
    break;

static void fail(Warp *warp, const char *what, int32_t at)
{
    warp->wrong = what;
    warp->wrong_at = at;
}

/* Have some threads go on apart from others of their party until they meet where it waits. */
static void add(Warp *warp, uint32_t mask, int32_t at, int32_t meet, int32_t depth)
{
    if (!mask || at == meet) return;
    if (warp->count == PARTIES) fail(warp, "more parties than there is room for", at);
    else warp->parties[warp->count++] = (Party){mask, at, meet, depth, depth};
}

/* Part the last party: some of it jump, the others go on. */
static void part(Warp *warp, uint32_t jumping, int32_t to, int32_t next, int32_t meet)
{
    Party *party = &warp->parties[warp->count - 1];
    uint32_t staying = party->mask & ~jumping;
    int32_t depth = party->depth;
    int met = party->meet == meet && (meet != EXIT || party->home == depth);
    if (met || (meet == EXIT && !depth)) warp->count--;  /* those before wait there already */
    else if (meet != EXIT) party->at = meet;
    else {
        party->at = warp->back[depth - 1][__builtin_ctz(party->mask)];
        party->depth--;
    }
    if (warp->chance) warp->chance = warp->chance * 6364136223846793005ull + 1442695040888963407ull;
    if (warp->chance >> 63) add(warp, jumping, to, meet, depth);
    add(warp, staying, next, meet, depth);
    if (!(warp->chance >> 63)) add(warp, jumping, to, meet, depth);
}

/* Let the last party go on until it parts, or meets others. */
static void go(Warp *warp)
{
    const Program *program = warp->program;
    Party *party = &warp->parties[warp->count - 1];
    uint32_t mask = party->mask, count = __builtin_popcount(mask);
    int32_t at = party->at;
    if (!mask) {  /* all of it have ended */
        warp->count--;
        return;
    }
    uint64_t full[LANES];
    for (int i = 0; i < LANES; i++) full[i] = -(uint64_t)(mask >> i & 1);
    for (;; at++) {
        if (at == party->meet) {
            warp->count--;
            return;
        }
        const Instruction *o = &program->instructions[at];
        uint64_t *D = warp->regs[o->d];
        const uint64_t *A = warp->regs[o->a], *B = warp->regs[o->b], *C = warp->regs[o->c];
        program->turns[at]++;
        program->threads[at] += count;
        switch (o->code) {
        case 0: {  /* bra */
            uint32_t taken = mask;
            if (o->guard >= 0) {
                const uint64_t *G = warp->regs[o->guard];
                taken = 0;
                for (int i = 0; i < LANES; i++)
                    taken |= (uint32_t)(G[i] == (uint64_t)o->wanted) << i;
                taken &= mask;
            }
            if (taken && taken != mask)
                return part(warp, taken, (int32_t)o->offset, at + 1, o->meet);
            if (taken) at = (int32_t)o->offset - 1;
            break;
        }
        case 1: {  /* brx.idx */
            const int32_t *table = program->targets + o->offset;
            uint32_t first = (uint32_t)A[__builtin_ctz(mask)], same = 0;
            if (first >= (uint32_t)table[0]) {
                fail(warp, "a branch beyond its table", at);
                return;
            }
            for (int i = 0; i < LANES; i++) same |= (uint32_t)((uint32_t)A[i] == first) << i;
            /* The others come here again. */
            same &= mask;
            if (same != mask) return part(warp, same, table[1 + first], at, o->meet);
            at = table[1 + first] - 1;
            break;
        }
        case 2:  /* call */
            if (party->depth == CALLS) {
                fail(warp, "more calls in calls than there is room for", at);
                return;
            }
            for (int i = 0; i < LANES; i++)
                if (mask >> i & 1) warp->back[party->depth][i] = at + 1;
            party->depth++;
            at = (int32_t)o->offset - 1;
            break;
        case 3:  /* ret */
            if (!party->depth || (party->meet == EXIT && party->depth == party->home)) {
                warp->count--;
                return;
            }
            party->depth--;
            at = warp->back[party->depth][__builtin_ctz(mask)] - 1;
            break;
        case 4:  /* exit */
            for (int k = 0; k < warp->count; k++) warp->parties[k].mask &= ~mask;
            return;
        case 5:  /* bar.warp.sync */
        case 6:  /* shfl.sync.idx: a from the thread that b and the segment say */
        case 7: {  /* vote.sync.ballot */
            uint64_t given[LANES];
            uint32_t votes = 0;
            for (int i = 0; i < LANES; i++) {
                if (mask >> i & 1 && (uint32_t)C[i] & ~mask) {
                    fail(warp, "threads that wait for others, which are elsewhere", at);
                    return;
                }
                given[i] = A[i];
                votes |= (uint32_t)(A[i] != 0) << i;
            }
            for (int i = 0; i < LANES; i++) {
                if (!(mask >> i & 1)) continue;
                if (o->code == 6) D[i] = (uint32_t)given[(i & 24) | (B[i] & 7)];
                if (o->code == 7) D[i] = votes & (uint32_t)C[i];
            }
            break;
        }
#include "instructions.inc"
        default:
            fail(warp, "an instruction that nobody knows", at);
            return;
        }
    }
}

static void fill(Warp *warp, int64_t reg, uint64_t value)
{
    for (int i = 0; i < LANES; i++) warp->regs[reg][i] = value;
}

/* Run all warps of a block. */
static void run_block(Warp *warp, uint32_t block, uint32_t threads)
{
    const Program *p = warp->program;
    memset(warp->shared, 0xcd, p->shared_size);
    for (int k = 0; k < p->shared_count; k++)
        fill(warp, p->shared[k].reg, (uint64_t)warp->shared + p->shared[k].value);
    fill(warp, p->special[2], block);
    for (uint32_t first = 0; first < threads && !warp->wrong; first += LANES) {
        memset(warp->local, 0xcd, LANES * p->local_size);
        for (int i = 0; i < LANES; i++) {
            warp->regs[p->special[0]][i] = first + i;
            for (int k = 0; k < p->local_count; k++)
                warp->regs[p->local[k].reg][i] =
                    (uint64_t)warp->local + i * p->local_size + p->local[k].value;
        }
        warp->count = 0;
        add(warp, UINT32_MAX, (int32_t)p->start, EXIT, 0);
        while (warp->count && !warp->wrong) go(warp);
    }
}

/* Run a kernel; in an order of its blocks drawn from a seed, or the usual one if that is 0. Return
   NULL, or what was wrong, at which instruction and address. */
const char *machine_run(const Program *p, int (*owns)(uint64_t, size_t), uint32_t blocks,
                        uint32_t threads, const uint64_t *parameters, uint64_t seed, int64_t *where)
{
    Warp warp = {.program = p, .owns = owns, .chance = seed};
    warp.regs = malloc(p->registers * sizeof *warp.regs);
    warp.shared = aligned_alloc(256, (p->shared_size + 511) / 256 * 256);
    warp.local = aligned_alloc(256, (LANES * p->local_size + 511) / 256 * 256);
    uint32_t *order = malloc(blocks * sizeof *order);
    memset(warp.regs, 0xcd, p->registers * sizeof *warp.regs);
    for (int k = 0; k < p->constants_count; k++)
        fill(&warp, p->constants[k].reg, (uint64_t)p->constants[k].value);
    for (int k = 0; k < p->data_count; k++)
        fill(&warp, p->data[k].reg, (uint64_t)p->content + p->data[k].value);
    for (int k = 0; k < 3; k++) fill(&warp, p->parameters[k], parameters[k]);
    fill(&warp, p->special[1], threads);
    for (uint32_t k = 0; k < blocks; k++) order[k] = k;
    for (uint32_t k = blocks; seed && k > 1; k--) {  /* Fisher and Yates */
        seed = seed * 6364136223846793005ull + 1442695040888963407ull;
        uint32_t other = (uint32_t)((seed >> 33) % k), kept = order[k - 1];
        order[k - 1] = order[other];
        order[other] = kept;
    }
    for (uint32_t k = 0; k < blocks && !warp.wrong; k++) run_block(&warp, order[k], threads);
    where[0] = warp.wrong_at;
    where[1] = (int64_t)warp.wrong_address;
    free(order);
    free(warp.local);
    free(warp.shared);
    free(warp.regs);
    return warp.wrong;
}

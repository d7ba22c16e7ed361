// bench_embree SHAPES(.sph|.cyl|.con|.tri) ROUNDS THREADS RAYS...
// Embree's build and its rates, one thread, for the very files that dotray traces. Prints what `ray_rates` prints.
// SHAPES is raw float32: x y z r; both ends with radii (cone-linear curves); nine numbers a triangle.
#ifdef EMBREE3
#include <embree3/rtcore.h>
#else
#include "embree4.h"
#endif
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>
#include <immintrin.h>
#include <time.h>
#include <unistd.h>

struct StoredRay { float origin[3], t_min, direction[3], t_max; };

static double seconds(clockid_t clock) {
    timespec t;
    clock_gettime(clock, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

template <class T> static std::vector<T> load(const std::string &path) {
    FILE *file = fopen(path.c_str(), "rb");
    if (!file) { perror(path.c_str()); exit(1); }
    fseek(file, 0, SEEK_END);
    std::vector<T> all(size_t(ftell(file)) / sizeof(T));
    rewind(file);
    if (fread(all.data(), sizeof(T), all.size(), file) != all.size()) { perror(path.c_str()); exit(1); }
    fclose(file);
    return all;
}

static std::atomic<long> held{0};
static bool count_memory(void *, ssize_t bytes, bool) { held += bytes; return true; }
static void tell(void *, RTCError code, const char *text) { fprintf(stderr, "Embree: %d %s\n", int(code), text); exit(1); }

// The two versions differ in where a call's options stand.
#ifdef EMBREE3
struct Options {
    RTCIntersectContext context;
    explicit Options(bool coherent) {
        rtcInitIntersectContext(&context);
        context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    }
};
static void nearest(RTCScene s, Options &o, RTCRayHit *r) { rtcIntersect1(s, &o.context, r); }
static void any(RTCScene s, Options &o, RTCRay *r) { rtcOccluded1(s, &o.context, r); }
static void nearest16(const int *v, RTCScene s, Options &o, RTCRayHit16 *r) { rtcIntersect16(v, s, &o.context, r); }
static void any16(const int *v, RTCScene s, Options &o, RTCRay16 *r) { rtcOccluded16(v, s, &o.context, r); }
#else
struct Options {
    RTCIntersectArguments arguments;
    explicit Options(bool coherent) : arguments() {
        arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
        arguments.feature_mask = RTC_FEATURE_FLAG_ALL;
    }
};
static void nearest(RTCScene s, Options &o, RTCRayHit *r) { rtcIntersect1(s, r, &o.arguments); }
static void any(RTCScene s, Options &o, RTCRay *r) { rtcOccluded1(s, r, &o.arguments); }
static void nearest16(const int *v, RTCScene s, Options &o, RTCRayHit16 *r) { rtcIntersect16(v, s, r, &o.arguments); }
static void any16(const int *v, RTCScene s, Options &o, RTCRay16 *r) { rtcOccluded16(v, s, r, &o.arguments); }
#endif

struct Shapes { std::vector<float> numbers; std::vector<unsigned> indices; size_t count; };

static RTCGeometry geometry(RTCDevice device, const std::string &path, Shapes &shapes) {
    shapes.numbers = load<float>(path);
    std::string kind = path.substr(path.rfind('.') + 1);
    size_t n = shapes.numbers.size();
    if (kind == "sph") {
        shapes.count = n / 4;
        RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, shapes.numbers.data(), 0, 16, n / 4);
        return g;
    }
    if (kind == "tri") {
        shapes.count = n / 9;
        shapes.numbers.resize(n + 4);   // Embree reads 16 bytes at the last vertex
        for (size_t i = 0; i < n / 3; i++) shapes.indices.push_back(unsigned(i));
        RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, shapes.numbers.data(), 0, 12, n / 3);
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, shapes.indices.data(), 0, 12, n / 9);
        return g;
    }
    shapes.count = n / 8;
    for (size_t i = 0; i < n / 8; i++) shapes.indices.push_back(unsigned(2 * i));
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, shapes.numbers.data(), 0, 16, n / 4);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, shapes.indices.data(), 0, 4, n / 8);
    return g;
}

static RTCScene build(const std::string &path, int threads, Shapes &shapes) {
    RTCDevice device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    rtcSetDeviceErrorFunction(device, tell, nullptr);
    rtcSetDeviceMemoryMonitorFunction(device, count_memory, nullptr);
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    RTCGeometry g = geometry(device, path, shapes);
    rtcSetGeometryBuildQuality(g, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitGeometry(g);
    rtcAttachGeometry(scene, g);
    rtcReleaseGeometry(g);
    double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID), wall = seconds(CLOCK_MONOTONIC);
    rtcCommitScene(scene);
    cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu, wall = seconds(CLOCK_MONOTONIC) - wall;
    // Properties 1 to 3 are the version's parts; the buffers are the caller's and count as well.
    long bytes = held + long(shapes.numbers.size() * 4 + shapes.indices.size() * 4);
    printf("BUILD,Embree %zd.%zd.%zd,%zu,%.4f,%.4f,%ld\n", rtcGetDeviceProperty(device, RTCDeviceProperty(1)),
           rtcGetDeviceProperty(device, RTCDeviceProperty(2)), rtcGetDeviceProperty(device, RTCDeviceProperty(3)),
           shapes.count, cpu, wall, bytes);
    return scene;
}

static void set(RTCRay &q, const StoredRay &r) {
    q.org_x = r.origin[0]; q.org_y = r.origin[1]; q.org_z = r.origin[2]; q.tnear = r.t_min;
    q.dir_x = r.direction[0]; q.dir_y = r.direction[1]; q.dir_z = r.direction[2]; q.tfar = r.t_max;
    q.time = 0; q.mask = ~0u; q.id = 0; q.flags = 0;
}

static void set16(RTCRay16 &q, const StoredRay *r) {
    for (int k = 0; k < 16; k++) {
        q.org_x[k] = r[k].origin[0]; q.org_y[k] = r[k].origin[1]; q.org_z[k] = r[k].origin[2]; q.tnear[k] = r[k].t_min;
        q.dir_x[k] = r[k].direction[0]; q.dir_y[k] = r[k].direction[1]; q.dir_z[k] = r[k].direction[2];
        q.tfar[k] = r[k].t_max; q.time[k] = 0; q.mask[k] = ~0u; q.id[k] = 0; q.flags[k] = 0;
    }
}

struct Sum { long hits; double t; };

static Sum singles(RTCScene scene, const std::vector<StoredRay> &rays, bool occlusion, Options &options) {
    Sum sum{0, 0};
    for (const StoredRay &ray : rays) {
        if (occlusion) {
            RTCRay q;
            set(q, ray);
            any(scene, options, &q);
            sum.hits += q.tfar < 0;
        } else {
            RTCRayHit q;
            set(q.ray, ray);
            q.hit.geomID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            nearest(scene, options, &q);
            if (q.hit.geomID != RTC_INVALID_GEOMETRY_ID) { sum.hits++; sum.t += double(q.ray.tfar); }
        }
    }
    return sum;
}

static Sum packets(RTCScene scene, const std::vector<StoredRay> &rays, bool occlusion, Options &options) {
    Sum sum{0, 0};
    alignas(64) int valid[16];
    for (int k = 0; k < 16; k++) valid[k] = -1;
    for (size_t i = 0; i + 16 <= rays.size(); i += 16) {
        if (occlusion) {
            RTCRay16 q;
            set16(q, &rays[i]);
            any16(valid, scene, options, &q);
            for (int k = 0; k < 16; k++) sum.hits += q.tfar[k] < 0;
        } else {
            RTCRayHit16 q;
            set16(q.ray, &rays[i]);
            for (int k = 0; k < 16; k++) q.hit.geomID[k] = q.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
            nearest16(valid, scene, options, &q);
            for (int k = 0; k < 16; k++)
                if (q.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID) { sum.hits++; sum.t += double(q.ray.tfar[k]); }
        }
    }
    return sum;
}

int main(int count, char **words) {
    if (count < 4) { fprintf(stderr, "usage: bench_embree SHAPES ROUNDS THREADS RAYS...\n"); return 2; }
    // As Embree's manual asks.
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    Shapes shapes;
    RTCScene scene = build(words[1], atoi(words[3]), shapes);
    int rounds = std::max(1, atoi(words[2]));
    for (int a = 4; a < count; a++) {
        std::string path = words[a], head = path.substr(0, path.rfind('.')), name = head.substr(head.rfind('.') + 1);
        std::vector<StoredRay> rays = load<StoredRay>(path);
        rays.resize(rays.size() / 16 * 16);
        bool occlusion = name == "shadow";
        Options options(name == "primary");
        for (int width : {1, 16}) {
            std::vector<double> times;
            Sum sum{0, 0};
            for (int r = 0; r < rounds; r++) {
                double start = seconds(CLOCK_THREAD_CPUTIME_ID);
                sum = width == 1 ? singles(scene, rays, occlusion, options) : packets(scene, rays, occlusion, options);
                times.push_back(seconds(CLOCK_THREAD_CPUTIME_ID) - start);
            }
            std::sort(times.begin(), times.end());
            double rate = double(rays.size()) / times[times.size() / 2] * 1e-6;
            printf("TRACE,%s,%s,%zu,%.4f,%ld,%.7f\n", name.c_str(), width == 1 ? "single" : "packet", rays.size(), rate,
                   sum.hits, sum.hits ? sum.t / double(sum.hits) : 0.0);
        }
    }
    fflush(stdout);
    _exit(0);   // taking everything down is not measured
}

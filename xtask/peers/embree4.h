// The few declarations of Embree 4's public C interface that the bench needs: Python wheels bring the library alone.
#pragma once
#include <cstddef>
#include <cstdint>
#include <sys/types.h>

extern "C" {
typedef struct RTCDeviceTy *RTCDevice;
typedef struct RTCSceneTy *RTCScene;
typedef struct RTCGeometryTy *RTCGeometry;

static const unsigned RTC_INVALID_GEOMETRY_ID = ~0u;
static const unsigned RTC_FEATURE_FLAG_ALL = ~0u;

enum RTCError { RTC_ERROR_NONE = 0 };
enum RTCDeviceProperty { RTC_DEVICE_PROPERTY_VERSION = 0 };
enum RTCGeometryType {
    RTC_GEOMETRY_TYPE_TRIANGLE = 0,
    RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE = 15,
    RTC_GEOMETRY_TYPE_SPHERE_POINT = 50
};
enum RTCBufferType { RTC_BUFFER_TYPE_INDEX = 0, RTC_BUFFER_TYPE_VERTEX = 1 };
enum RTCFormat {
    RTC_FORMAT_UINT = 0x5001,
    RTC_FORMAT_UINT3 = 0x5003,
    RTC_FORMAT_FLOAT3 = 0x9003,
    RTC_FORMAT_FLOAT4 = 0x9004
};
enum RTCBuildQuality { RTC_BUILD_QUALITY_MEDIUM = 1 };
enum RTCRayQueryFlags { RTC_RAY_QUERY_FLAG_INCOHERENT = 0, RTC_RAY_QUERY_FLAG_COHERENT = 1 << 16 };

struct alignas(16) RTCRay {
    float org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar;
    unsigned mask, id, flags;
};
struct alignas(16) RTCHit {
    float Ng_x, Ng_y, Ng_z, u, v;
    unsigned primID, geomID, instID[1], instPrimID[1];
};
struct alignas(16) RTCRayHit {
    RTCRay ray;
    RTCHit hit;
};
struct alignas(64) RTCRay16 {
    float org_x[16], org_y[16], org_z[16], tnear[16], dir_x[16], dir_y[16], dir_z[16], time[16], tfar[16];
    unsigned mask[16], id[16], flags[16];
};
struct alignas(64) RTCHit16 {
    float Ng_x[16], Ng_y[16], Ng_z[16], u[16], v[16];
    unsigned primID[16], geomID[16], instID[1][16], instPrimID[1][16];
};
struct RTCRayHit16 {
    RTCRay16 ray;
    RTCHit16 hit;
};
// Intersect and occluded arguments have the same members.
struct RTCIntersectArguments {
    RTCRayQueryFlags flags;
    unsigned feature_mask;
    void *context;
    void (*filter)(const void *);
    void (*callback)(const void *);
    float min_width_distance_factor;
};
typedef RTCIntersectArguments RTCOccludedArguments;

RTCDevice rtcNewDevice(const char *config);
ssize_t rtcGetDeviceProperty(RTCDevice, RTCDeviceProperty);
void rtcSetDeviceErrorFunction(RTCDevice, void (*)(void *, RTCError, const char *), void *);
void rtcSetDeviceMemoryMonitorFunction(RTCDevice, bool (*)(void *, ssize_t, bool), void *);
RTCScene rtcNewScene(RTCDevice);
void rtcSetSceneBuildQuality(RTCScene, RTCBuildQuality);
void rtcCommitScene(RTCScene);
RTCGeometry rtcNewGeometry(RTCDevice, RTCGeometryType);
void rtcSetSharedGeometryBuffer(RTCGeometry, RTCBufferType, unsigned slot, RTCFormat, const void *, size_t offset,
                                size_t stride, size_t count);
void rtcSetGeometryBuildQuality(RTCGeometry, RTCBuildQuality);
void rtcCommitGeometry(RTCGeometry);
unsigned rtcAttachGeometry(RTCScene, RTCGeometry);
void rtcReleaseGeometry(RTCGeometry);
void rtcIntersect1(RTCScene, RTCRayHit *, RTCIntersectArguments *);
void rtcOccluded1(RTCScene, RTCRay *, RTCOccludedArguments *);
void rtcIntersect16(const int *valid, RTCScene, RTCRayHit16 *, RTCIntersectArguments *);
void rtcOccluded16(const int *valid, RTCScene, RTCRay16 *, RTCOccludedArguments *);
}

// parse_floor SCENE.ray: a floor for reading the text, one thread: every line of spheres through std::from_chars, no
// checks, no positions. Prints what `parse_rate` prints.
#include <charconv>
#include <cstdio>
#include <cstring>
#include <vector>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>

static double seconds(clockid_t clock) {
    timespec t;
    clock_gettime(clock, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

int main(int count, char **words) {
    if (count != 2) return 2;
    double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID), wall = seconds(CLOCK_MONOTONIC);
    int file = open(words[1], O_RDONLY);
    struct stat status;
    if (file < 0 || fstat(file, &status)) { perror(words[1]); return 1; }
    size_t size = size_t(status.st_size);
    const char *p = static_cast<const char *>(mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, file, 0));
    const char *end = p + size, *word = "#shape_sphere ";
    std::vector<double> numbers;
    while (p < end) {
        const char *line_end = static_cast<const char *>(memchr(p, '\n', size_t(end - p)));
        if (!line_end) line_end = end;
        if (size_t(line_end - p) > strlen(word) && !memcmp(p, word, strlen(word))) {
            p += strlen(word);
            for (int i = 0; i < 5; i++) {
                while (p < line_end && *p == ' ') p++;
                double number = 0;
                p = std::from_chars(p, line_end, number).ptr;
                numbers.push_back(number);
            }
        }
        p = line_end + 1;
    }
    cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu, wall = seconds(CLOCK_MONOTONIC) - wall;
    printf("PARSE,%zu,%.4f,%.4f\n", size, cpu, wall);
    return numbers.empty();
}

/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* The functions of libusb-1.0 that libnxt's programs call, for one device that is played at the
   other end of the socket RAVENBRICK_PLAYED_USB (played_usb.py here). A request is
   endpoint and length, then the bytes for the device; an answer is status and length, then the
   bytes from the device. Endpoint 0 asks for the device descriptor. */

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/un.h>
#include <unistd.h>

enum { DIRECTION_IN = 0x80, ERROR_IO = -1, ERROR_NO_DEVICE = -4, DESCRIPTOR_BYTES = 18 };

struct head {
  int32_t first;
  uint32_t length;
};

static int line = -1;
static char device;

static int move_all(ssize_t (*move)(int, void *, size_t), void *data, size_t length) {
  for (size_t done = 0; done < length;) {
    const ssize_t count = move(line, (char *)data + done, length - done);
    if (count <= 0)
      return 0;
    done += (size_t)count;
  }
  return 1;
}

static ssize_t send_some(int to, void *data, size_t length) { return write(to, data, length); }

static int transfer(unsigned char endpoint, void *data, uint32_t length, uint32_t *moved) {
  const int into_host = endpoint == 0 || (endpoint & DIRECTION_IN);
  struct head head = {endpoint, length};
  if (!move_all(send_some, &head, sizeof head))
    return ERROR_IO;
  if (!into_host && !move_all(send_some, data, length))
    return ERROR_IO;
  if (!move_all(read, &head, sizeof head) || head.length > length)
    return ERROR_IO;
  if (into_host && !move_all(read, data, head.length))
    return ERROR_IO;
  *moved = head.length;
  return head.first;
}

int libusb_init(void **context) {
  const char *path = getenv("RAVENBRICK_PLAYED_USB");
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  if (context)
    *context = &device;
  if (!path || strlen(path) >= sizeof address.sun_path)
    return ERROR_NO_DEVICE;
  strcpy(address.sun_path, path);
  line = socket(AF_UNIX, SOCK_STREAM, 0);
  return connect(line, (struct sockaddr *)&address, sizeof address) ? ERROR_NO_DEVICE : 0;
}

void libusb_exit(void *context) {
  (void)context;
  close(line);
}

ssize_t libusb_get_device_list(void *context, void ***list) {
  (void)context;
  *list = calloc(2, sizeof **list);
  (*list)[0] = &device;
  return 1;
}

void libusb_free_device_list(void **list, int unref) {
  (void)unref;
  free(list);
}

int libusb_get_device_descriptor(void *of, void *descriptor) {
  uint32_t moved = 0;
  (void)of;
  return transfer(0, descriptor, DESCRIPTOR_BYTES, &moved);
}

int libusb_bulk_transfer(void *handle, unsigned char endpoint, unsigned char *data, int length,
                         int *moved, unsigned int timeout_ms) {
  uint32_t count = 0;
  const int status = transfer(endpoint, data, (uint32_t)length, &count);
  (void)handle;
  (void)timeout_ms;
  if (moved)
    *moved = (int)count;
  return status;
}

void *libusb_ref_device(void *of) { return of; }

void libusb_unref_device(void *of) { (void)of; }

int libusb_open(void *of, void **handle) {
  *handle = of;
  return 0;
}

void libusb_close(void *handle) { (void)handle; }

int libusb_set_configuration(void *handle, int configuration) {
  (void)handle;
  (void)configuration;
  return 0;
}

int libusb_claim_interface(void *handle, int interface) {
  (void)handle;
  (void)interface;
  return 0;
}

int libusb_release_interface(void *handle, int interface) {
  (void)handle;
  (void)interface;
  return 0;
}

int libusb_detach_kernel_driver(void *handle, int interface) {
  (void)handle;
  (void)interface;
  return 0;
}

const char *libusb_strerror(int error) {
  (void)error;
  return "error of the played device";
}

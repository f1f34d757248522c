/* A driver's half that talks to its device, in a process of its own, so that it outlives the client: when the client is
 * killed or stopped, this half goes on and ends the force once no command has come for its hold time.
 *
 * Both halves share one struct in memory that both processes have. It is begun before the vendor's library is loaded,
 * which only the child knows. The parent asks for one thing at a time by a byte over a socket; what the tick hands over
 * goes through mailboxes in the struct and waits for nobody.
 */
#ifndef FORCEBOUND_DRIVERS_OWN_PROCESS_H
#define FORCEBOUND_DRIVERS_OWN_PROCESS_H

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stddef.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pause.h"

/* Does what is asked for and returns what a function of a driver returns. */
typedef int (*own_process_serve)(void* shared, char wish);

typedef struct own_process {
  int socket; /* below zero: there is no such process */
  pid_t child;
} own_process;

/* Zeros that a child will share. NULL: no memory. */
static inline void* own_process_memory(size_t bytes) {
  void* const memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return memory == MAP_FAILED ? NULL : memory;
}

/* Else a crash of the vendor's library would run what the client does at a crash, and might not end the child. */
static inline void own_process_forget_handlers(void) {
  static const int kEnding[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM};
  sigset_t none;
  size_t i;
  for (i = 0; i < sizeof kEnding / sizeof *kEnding; ++i) signal(kEnding[i], SIG_DFL);
  sigemptyset(&none);
  (void)sigprocmask(SIG_SETMASK, &none, NULL);
}

/* The child: serves until the parent is gone or has closed its end, then takes the wish `last` and ends, in time
 * even if a call of the vendor's library hangs. */
static inline void own_process_live(int socket, own_process_serve serve, void* shared, char last) {
  static const unsigned kLastMost_s = 5;
  static const int kOfTheTerminal[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP};
  size_t i;
  char wish;
  ssize_t count;
  own_process_forget_handlers();
  /* The client ends at these, and lets us go on to zero force. */
  for (i = 0; i < sizeof kOfTheTerminal / sizeof *kOfTheTerminal; ++i) signal(kOfTheTerminal[i], SIG_IGN);
  (void)setsid();
  for (;;) {
    int result;
    count = recv(socket, &wish, 1, 0);
    if (count < 0 && errno == EINTR) continue;
    if (count != 1) break;
    result = serve(shared, wish);
    if (send(socket, &result, sizeof result, MSG_NOSIGNAL) != (ssize_t)sizeof result) break;
  }
  signal(SIGALRM, SIG_DFL); /* the library may have taken it */
  alarm(kLastMost_s);
  (void)serve(shared, last);
  _exit(0);
}

/* 0: there can be none. */
static inline int own_process_begin(own_process* process, own_process_serve serve, void* shared, char last) {
  int ends[2];
  pid_t child;
  process->socket = -1;
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) return 0;
  child = fork();
  if (child == 0) {
    close(ends[0]);
    own_process_live(ends[1], serve, shared, last);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return 0;
  }
  /* By the parent alone: the struct is the child's too. */
  process->child = child;
  process->socket = ends[0];
  return 1;
}

/* What the child's function returned; below zero: it has ended, or did not answer in time. */
static inline int own_process_ask(const own_process* process, char wish, int limit_ms) {
  struct pollfd answer = {.fd = process->socket, .events = POLLIN};
  int result = -1;
  if (send(process->socket, &wish, 1, MSG_NOSIGNAL) != 1) return -1;
  while (poll(&answer, 1, limit_ms) < 0 && errno == EINTR) {
  }
  if (recv(process->socket, &result, sizeof result, MSG_DONTWAIT) != (ssize_t)sizeof result) return -1;
  return result;
}

/* Whether the child has ended. Waits for nothing. */
static inline int own_process_is_gone(const own_process* process) {
  char unread;
  return recv(process->socket, &unread, 1, MSG_DONTWAIT | MSG_PEEK) == 0;
}

/* Lets the child end, or ends it if it does not within the limit. */
static inline void own_process_end(own_process* process, int limit_ms) {
  const long kLook_ns = 1000000;
  int waited_ms;
  if (process->socket < 0) return;
  close(process->socket);
  process->socket = -1;
  for (waited_ms = 0; waited_ms < limit_ms; ++waited_ms) {
    if (waitpid(process->child, NULL, WNOHANG) != 0) return;
    rest(kLook_ns);
  }
  kill(process->child, SIGKILL);
  (void)waitpid(process->child, NULL, 0);
}

#endif

// The real programs as processes on the loopback.
import { spawn } from "node:child_process";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";

const kListening = /listening on (127\.0\.0\.1:\d+)/;
const kControl = /new impairments are taken at (127\.0\.0\.1:\d+)/;
const kPage = /(http:\/\/\S+\?token=[\w-]+)/;

/** A process whose output is kept, to be shown where a test fails. */
class Program {
  constructor(path, options, folder) {
    this.name = options[0];
    this.said = "";
    this.process = spawn(path, options, { cwd: folder, stdio: ["ignore", "pipe", "pipe"] });
    this.ended = new Promise((done) => this.process.on("exit", done));
    for (const stream of [this.process.stdout, this.process.stderr]) {
      stream.setEncoding("utf8");
      stream.on("data", (text) => {
        this.said += text;
        this.heard?.();
      });
    }
  }

  /** Waits until it has said this. @returns {Promise<string>} the first group of the expression */
  async says(expression) {
    const seen = () => expression.exec(this.said)?.[1];
    while (!seen()) {
      const more = new Promise((done) => (this.heard = done));
      const ended = await Promise.race([more.then(() => false), this.ended.then(() => true)]);
      if (ended && !seen()) throw new Error(`${this.name} ended without saying ${expression}; it said:\n${this.said}`);
    }
    return seen();
  }

  /** Ends it as Ctrl-C does. */
  async end() {
    if (this.process.exitCode === null) this.process.kill("SIGINT");
    await this.ended;
  }
}

/** Server, relay and client of a build, and other commands of `forcebound`, each on a port that the system chooses. */
class Programs {
  constructor(bin, folder) {
    this.bin = bin;
    this.folder = folder;
    this.all = [];
  }

  start(command, options) {
    const program = new Program(join(this.bin, "forcebound"), [command, ...options], this.folder);
    this.all.push(program);
    return program;
  }

  async server(options = []) {
    const server = this.start("server", ["--listen", "127.0.0.1:0", ...options]);
    server.address = await server.says(kListening);
    return server;
  }

  async relay(upstream, netem) {
    const relay = this.start("relay", ["--listen", "127.0.0.1:0", "--upstream", upstream, "--control", "127.0.0.1:0", "--netem", netem]);
    relay.address = await relay.says(kListening);
    relay.control = await relay.says(kControl);
    return relay;
  }

  /** A program with a page. @returns {Promise<Program & {url: string}>} */
  async withPage(name, options) {
    const program = this.start(name, [...options, "--page", "0"]);
    program.url = await program.says(kPage);
    return program;
  }

  /** A client of a server through a relay, with a page. @param {string[]} served options of the server */
  async client(netem, options = [], served = []) {
    this.served = await this.server(served);
    this.between = await this.relay(this.served.address, netem);
    return this.withPage("client", ["--server", this.between.address, "--relay-control", this.between.control,
      "--scene-cache", "none", "--quiet", ...options]);
  }

  async end() {
    for (const program of this.all.reverse()) await program.end();
    await rm(this.folder, { recursive: true, force: true });
  }

  /** What all have said, for who looks for a failure. */
  said() {
    return this.all.map(({ name, said }) => `--- ${name}\n${said}`).join("\n");
  }
}

/** Programs of a build for what `then` does with them; they end with it, and what they said is told if it fails. */
export async function withPrograms(bin, then) {
  const programs = new Programs(bin, await mkdtemp(join(tmpdir(), "forcebound-page-")));
  try {
    await then(programs);
  } catch (error) {
    console.error(programs.said());
    throw error;
  } finally {
    await programs.end();
  }
}

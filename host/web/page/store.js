// Journals of recording sessions, which the browser keeps until they are deleted: a tab that is closed or killed loses nothing.

const LINES = "lines";

const done = (request) => new Promise((resolve, reject) => {
  request.onsuccess = () => resolve(request.result);
  request.onerror = () => reject(request.error);
});

/** Keys of a journal: its name, and the number of the lines. */
const range = (name) => IDBKeyRange.bound([name], [name, []]);

export class Store {
  #base = this.#open();
  #next = 0;

  async #open() {
    const request = indexedDB.open("myointent", 1);
    request.onupgradeneeded = () => request.result.createObjectStore(LINES);
    return done(request);
  }

  async #lines(mode) {
    return (await this.#base).transaction(LINES, mode, { durability: "strict" }).objectStore(LINES);
  }

  /** Appends lines to a journal; fails where the browser keeps nothing. */
  async append(name, text) {
    const key = [name, this.#next];
    this.#next += 1;
    await done((await this.#lines("readwrite")).put(text, key));
  }

  /** Names of the journals, the newest last. */
  async names() {
    const keys = await done((await this.#lines("readonly")).getAllKeys());
    return [...new Set(keys.map(([name]) => name))];
  }

  async read(name) {
    return (await done((await this.#lines("readonly")).getAll(range(name)))).join("");
  }

  async remove(name) {
    await done((await this.#lines("readwrite")).delete(range(name)));
  }
}

// Requests that follow a hand: one is in flight, and only the newest of those that came meanwhile is asked next.

/** Calls `show` with the result of `answer(question, signal)` and the question. */
export class Live {
  #answer;
  #show;
  #next = null;
  #flight = null;

  constructor(answer, show) {
    this.#answer = answer;
    this.#show = show;
  }

  /** Asks when the request in flight is answered, unless a newer question comes first; `urgent` drops the request in flight. */
  ask(question, urgent = false) {
    if (urgent) this.stop();
    this.#next = question;
    if (!this.#flight) this.#fly();
  }

  /** Whether a question waits for the request in flight. */
  get waiting() {
    return this.#next !== null;
  }

  /** Drops the request in flight and the question that waits for it. */
  stop() {
    this.#next = null;
    this.#flight?.abort();
    this.#flight = null;
  }

  async #fly() {
    const question = this.#next, mine = (this.#flight = new AbortController());
    this.#next = null;
    try {
      const answer = await this.#answer(question, mine.signal);
      if (mine === this.#flight) this.#show(answer, question);
    } catch (error) {
      if (!mine.signal.aborted) throw error;
    } finally { // also after an error: the next question is asked
      if (mine === this.#flight) {
        this.#flight = null;
        if (this.waiting) this.#fly();
      }
    }
  }
}

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <stdexcept>
#include <utility>

#include "tests/support/ros2/bus.hpp"
#include "tests/support/ros2/cdr.hpp"

namespace forcebound::ros2_peer {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

template <class Message>
class CdrType final : public dds::TopicDataType {
 public:
  explicit CdrType(const std::string& name) {
    constexpr std::uint32_t kBytesMost = 2048;
    setName(name.c_str());
    m_typeSize = kBytesMost;
    m_isGetKeyDefined = false;
  }

  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    CdrWriter writer;
    static_cast<Message*>(data)->each(writer);
    if (writer.bytes().size() > payload->max_size) return false;
    std::ranges::copy(writer.bytes(), payload->data);
    payload->length = static_cast<std::uint32_t>(writer.bytes().size());
    payload->encapsulation = CDR_LE;
    return true;
  }

  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    try {
      CdrReader reader({payload->data, payload->length});
      static_cast<Message*>(data)->each(reader);
      return true;
    } catch (const std::runtime_error&) {
      return false;
    }
  }

  std::function<std::uint32_t()> getSerializedSizeProvider(void* /*data*/) override {
    return [this] { return m_typeSize; };
  }
  void* createData() override { return new Message(); }
  void deleteData(void* data) override { delete static_cast<Message*>(data); }
  bool getKey(void* /*data*/, rtps::InstanceHandle_t* /*handle*/, bool /*md5*/) override { return false; }
};

template <class Message>
class Listener final : public dds::DataReaderListener {
 public:
  explicit Listener(std::function<void(const Message&)> hear) : hear_(std::move(hear)) {}

  void on_data_available(dds::DataReader* reader) override {
    Message message;
    dds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) hear_(message);
    }
  }

 private:
  std::function<void(const Message&)> hear_;
};

dds::DomainParticipantQos loopback_qos() {
  dds::DomainParticipantQos qos;
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  rtps::Locator_t loopback;
  rtps::IPLocator::setIPv4(loopback, 127, 0, 0, 1);
  qos.wire_protocol().builtin.initialPeersList.push_back(loopback);
  rtps::Locator_t own;
  rtps::IPLocator::setIPv4(own, 127, 0, 0, 1);
  qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(own);
  return qos;
}

template <class Made>
Made* made(Made* entity, const char* what) {
  if (entity == nullptr) throw std::runtime_error(std::string("Fast DDS makes no ") + what);
  return entity;
}

class FastBus final : public Bus {
 public:
  FastBus(const Settings& settings, Ears ears)
      : settings_(settings),
        pose_(std::move(ears.pose)),
        twist_(std::move(ears.twist)),
        wrench_(std::move(ears.wrench)),
        joints_(std::move(ears.joints)),
        joy_(std::move(ears.joy)),
        state_(std::move(ears.state)),
        participant_(
            made(dds::DomainParticipantFactory::get_instance()->create_participant(settings.domain, loopback_qos()),
                 "participant")),
        subscriber_(made(participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT), "subscriber")) {
    subscribe<Pose>("measured_cp", "geometry_msgs::msg::dds_::PoseStamped_", pose_);
    subscribe<Twist>("measured_cv", "geometry_msgs::msg::dds_::TwistStamped_", twist_);
    subscribe<Wrench>("measured_cf", "geometry_msgs::msg::dds_::WrenchStamped_", wrench_);
    subscribe<JointState>("measured_js", "sensor_msgs::msg::dds_::JointState_", joints_);
    subscribe<Joy>("joy", "sensor_msgs::msg::dds_::Joy_", joy_);
    subscribe<OperatingState>("operating_state", "crtk_msgs::msg::dds_::OperatingState_", state_, true);
    dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
    qos.reliability().kind = reliability();
    qos.history().depth = kDepth;
    if (settings_.exclusive) qos.ownership().kind = dds::EXCLUSIVE_OWNERSHIP_QOS;
    dds::Publisher* const publisher = made(participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT), "publisher");
    writer_ = made(publisher->create_datawriter(topic<Wrench>("servo_cf", settings_.type), qos), "writer");
  }

  ~FastBus() override {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  void publish(const Wrench& wrench) override {
    Wrench copy = wrench;
    writer_->write(&copy);
  }

  [[nodiscard]] bool matched() const override {
    dds::PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count > 0;
  }

 private:
  static constexpr std::int32_t kDepth = 10;

  [[nodiscard]] dds::ReliabilityQosPolicyKind reliability() const {
    return settings_.best_effort ? dds::BEST_EFFORT_RELIABILITY_QOS : dds::RELIABLE_RELIABILITY_QOS;
  }

  template <class Message>
  dds::Topic* topic(const std::string& name, const std::string& type) {
    const dds::TypeSupport support(new CdrType<Message>(type));
    if (participant_->find_type(type).empty()) support.register_type(participant_);
    return made(participant_->create_topic("rt" + settings_.name_space + "/" + name, type, dds::TOPIC_QOS_DEFAULT),
                "topic");
  }

  template <class Message>
  void subscribe(const std::string& name, const std::string& type, Listener<Message>& listener, bool latched = false) {
    dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = latched ? dds::RELIABLE_RELIABILITY_QOS : reliability();
    qos.history().depth = kDepth;
    qos.durability().kind = latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
    made(subscriber_->create_datareader(topic<Message>(name, type), qos, &listener), "reader");
  }

  Settings settings_;
  Listener<Pose> pose_;
  Listener<Twist> twist_;
  Listener<Wrench> wrench_;
  Listener<JointState> joints_;
  Listener<Joy> joy_;
  Listener<OperatingState> state_;
  dds::DomainParticipant* participant_;
  dds::Subscriber* subscriber_;
  dds::DataWriter* writer_ = nullptr;
};

}  // namespace

std::unique_ptr<Bus> fast_bus(const Settings& settings, Ears ears) {
  return std::make_unique<FastBus>(settings, std::move(ears));
}

}  // namespace forcebound::ros2_peer
